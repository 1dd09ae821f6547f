// The bar of a recording: play, pause, seek, speed, a tick at a time, from one transition to the next.
import { html, signal, useRef } from "./html.js";
import { tell } from "./connection.js";
import { Icon } from "./icons.js";
import { clock } from "./format.js";
import { live, timeline } from "./flight_state.js";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, 20];
const chosen = signal(1); // speed to play at
const SEEK_EVERY = 60; // ms while the slider is dragged

export function PlaybackBar() {
  const playback = live("playback").value;
  if (!playback) return null;
  const { at, playing, end } = playback;
  const tick = live("tick").value;
  return html`<section class="bar playback" aria-label="playback">
    <div class="buttons">
      <button type="button" class="plain" aria-label="transition before" onClick=${() => jump(at, -1)}><${Icon} name="before" /></button>
      <button type="button" class="plain" aria-label="one tick back" onClick=${() => tell({ t: "step", by: -1 })}>−1</button>
      <button
        type="button"
        class="plain play"
        aria-label=${playing ? "pause" : "play"}
        onClick=${() => tell(playing ? { t: "pause" } : { t: "play", speed: chosen.value })}
      ><${Icon} name=${playing ? "pause" : "play"} /></button>
      <button type="button" class="plain" aria-label="one tick on" onClick=${() => tell({ t: "step", by: 1 })}>+1</button>
      <button type="button" class="plain" aria-label="next transition" onClick=${() => jump(at, 1)}><${Icon} name="next" /></button>
    </div>
    <${Seek} at=${at} end=${end} />
    <span class="clock"><b>${clock(at)}</b> <span>of ${clock(end)}</span> <small>tick ${tick}</small></span>
    <label class="speed">
      <span>speed</span>
      <select value=${String(chosen.value)} onChange=${(event) => choose(Number(event.target.value), playing)}>
        ${SPEEDS.map((it) => html`<option key=${it} value=${String(it)}>${it}×</option>`)}
      </select>
    </label>
  </section>`;
}

/** A paused recording stays paused. */
function choose(speed, playing) {
  chosen.value = speed;
  if (playing) tell({ t: "play", speed });
}

function Seek({ at, end }) {
  const last = useRef(-Infinity);
  const drag = (event) => {
    const now = performance.now();
    if (event.type === "input" && now - last.current < SEEK_EVERY) return;
    last.current = now;
    tell({ t: "seek", at: Number(event.target.value) });
  };
  return html`<input
    type="range"
    class="seek"
    min="0"
    max=${end}
    step="0.05"
    value=${at}
    aria-label="time"
    aria-valuetext=${clock(at)}
    onInput=${drag}
    onChange=${drag}
  />`;
}

const CLOSE = 0.02; // s: the transition where playback stands is not the next one

function jump(at, way) {
  const times = timeline.value.fired.map((it) => it.at);
  const next = way > 0 ? times.find((it) => it > at + CLOSE) : times.findLast((it) => it < at - CLOSE);
  tell({ t: "seek", at: next ?? (way > 0 ? live("playback").value.end : 0) });
}
