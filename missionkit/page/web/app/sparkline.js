// The last 30 seconds of a guard: its value against the threshold, and when it held.
import { html } from "./html.js";
import { useCanvas } from "./canvas_hook.js";
import { live } from "./flight_state.js";
import { filled, historyOf, SPAN } from "./guard_history.js";
import { colour, prepared } from "./theme.js";

const EVERY = 200; // ms
const STRIP = 3; // px at the bottom: held, did not, unknown

export function Sparkline({ name }) {
  const canvas = useCanvas(
    () => [live("now").value, filled.value],
    (it) => draw(it, name),
    EVERY,
  );
  return html`<canvas class="spark" ref=${canvas} aria-hidden="true"></canvas>`;
}

function draw(canvas, name) {
  const { context, width, height } = prepared(canvas);
  const { at, value, threshold, holds } = historyOf(name);
  if (!at.length) return;
  const end = at.at(-1);
  const x = (time) => width * (1 - (end - time) / SPAN);
  drawVerdicts(context, { at, holds, x, width, height });
  const seen = [...value, ...threshold].filter((it) => it !== null);
  if (!seen.length) return;
  const [low, high] = [Math.min(...seen), Math.max(...seen)];
  const room = height - STRIP - 4;
  const y = (it) => 2 + room * (1 - (it - low) / (high - low || 1));
  context.lineWidth = 1;
  drawLine(context, { at, values: threshold, x, y }, colour("muted"), [3, 3]);
  context.lineWidth = 1.5;
  drawLine(context, { at, values: value, x, y }, colour("ink"), []);
}

function drawLine(context, { at, values, x, y }, stroke, dash) {
  context.strokeStyle = stroke;
  context.setLineDash(dash);
  context.beginPath();
  let open = false;
  values.forEach((it, index) => {
    if (it === null) return void (open = false);
    if (open) context.lineTo(x(at[index]), y(it));
    else context.moveTo(x(at[index]), y(it));
    open = true;
  });
  context.stroke();
}

const VERDICT_COLOURS = { true: "holds", false: "not", null: "unknown" };

function drawVerdicts(context, { at, holds, x, width, height }) {
  at.forEach((time, index) => {
    const next = at[index + 1] === undefined ? width : x(at[index + 1]);
    if (next < 0) return;
    const high = holds[index] === true ? STRIP : holds[index] === false ? 1 : STRIP / 2;
    context.fillStyle = colour(VERDICT_COLOURS[String(holds[index])]);
    context.fillRect(x(time), height - high, Math.max(next - x(time), 0.5), high);
  });
}
