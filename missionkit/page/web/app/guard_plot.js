// One guard's value and threshold over the last 30 seconds, with axes. uPlot is loaded by need.
import { effect, html, useEffect, useRef } from "./html.js";
import { live, mission } from "./flight_state.js";
import { filled, historyOf } from "./guard_history.js";
import { colour, theme } from "./theme.js";

const EVERY = 250; // ms
const HEIGHT = 150; // px

export function GuardPlot({ name }) {
  const place = useRef(null);
  useEffect(() => {
    let plot = null;
    let stop = () => {};
    let left = false;
    let timer = 0;
    const draw = () => {
      timer = 0;
      plot.setData(data(name));
    };
    import("../vendor/uplot/uPlot.js").then(({ default: UPlot }) => {
      if (left) return;
      plot = new UPlot(options(name, place.current.clientWidth), data(name), place.current);
      stop = effect(() => {
        live("now").value;
        filled.value;
        timer ||= setTimeout(draw, EVERY);
      });
    });
    return () => {
      left = true;
      stop();
      clearTimeout(timer);
      plot?.destroy();
    };
  }, [name, theme.value]);
  return html`<div class="plot" ref=${place} role="img" aria-label=${`${name}: value and threshold, last 30 s`}></div>`;
}

function data(name) {
  const { at, value, threshold } = historyOf(name);
  return [at, value, threshold];
}

function options(name, width) {
  const axis = { stroke: colour("muted"), grid: { stroke: colour("line"), width: 1 }, ticks: { show: false } };
  const unit = mission.value?.guards?.[name]?.unit ?? "";
  return {
    width,
    height: HEIGHT,
    legend: { show: false },
    scales: { x: { time: false } },
    axes: [{ ...axis, label: "s", labelSize: 16, size: 26 }, { ...axis, label: unit, labelSize: unit ? 16 : 0, size: 46 }],
    series: [
      {},
      { stroke: colour("accent"), width: 2, spanGaps: false },
      { stroke: colour("muted"), width: 1, dash: [4, 4] },
    ],
  };
}
