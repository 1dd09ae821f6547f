// A mission without a flight: every quantity is a slider, every fault a button, time goes by hand.
import { html, signal, useEffect } from "./html.js";
import { clock, number } from "./format.js";
import { Icon } from "./icons.js";
import { live, mission } from "./flight_state.js";
import { post } from "./server.js";

const RUN_EVERY = 100; // ms
const failed = signal("");
const running = signal(false);

async function send(body) {
  try {
    await post("/api/play", body);
    failed.value = "";
  } catch (error) {
    failed.value = error.message;
    running.value = false;
  }
}

let waiting = null; // the latest of what a dragged slider says, while an answer is awaited
let busy = false;

async function set(quantity) {
  waiting = { ...waiting, ...quantity };
  if (busy) return;
  busy = true;
  while (waiting) {
    const next = waiting;
    waiting = null;
    await send({ quantity: next });
  }
  busy = false;
}

/** Sliders and faults. */
export function PlayPanel() {
  const play = live("play").value;
  if (!play) return null;
  const active = play.active_faults ?? [];
  return html`<section class="panel play-panel" aria-label="quantities">
    <h2>Quantities <small>what the guards read</small></h2>
    <ul class="rows" tabindex="0" aria-label="quantities">
      ${play.quantities.map((it) => html`<${Quantity} key=${it.name} it=${it} />`)}
    </ul>
    ${!!play.faults.length &&
    html`<div class="faults" role="group" aria-label="faults">
      ${play.faults.map(
        (name) => html`<button
          key=${name}
          type="button"
          class="plain"
          aria-pressed=${active.includes(name) ? "true" : "false"}
          onClick=${() => send({ fault: name })}
        ><span class="cut">${name}</span></button>`,
      )}
    </div>`}
  </section>`;
}

function Quantity({ it }) {
  const known = it.known !== false;
  const step = it.whole ? 1 : (it.max - it.min) / 200 || 0.01;
  return html`<li class="quantity" data-quantity=${it.name}>
    <label>
      <span class="name cut">${it.name}</span>
      <output>${known ? wordOf(it) : "unknown"}</output>
      <input
        type="range"
        min=${it.min}
        max=${it.max}
        step=${step}
        value=${it.value ?? it.min}
        list=${it.thresholds?.length ? `at ${it.name}` : undefined}
        disabled=${!known}
        aria-valuetext=${wordOf(it)}
        onInput=${(event) => set({ [it.name]: Number(event.target.value) })}
      />
      ${!!it.thresholds?.length &&
      html`<datalist id=${`at ${it.name}`}>${it.thresholds.map((at) => html`<option value=${at} />`)}</datalist>`}
    </label>
    <label class="known">
      <input type="checkbox" checked=${known} onChange=${() => set({ [it.name]: known ? null : (it.value ?? it.min) })} />
      <span>known</span>
    </label>
  </li>`;
}

/** A value, or the word that stands for it. */
function wordOf(it) {
  if (it.words?.length) return it.words[Math.round(it.value)] ?? "–";
  if (it.whole && it.max - it.min === 1) return it.value > it.min ? "yes" : "no";
  return number(it.value, it.unit);
}

/** The bar of a play: time by hand, events, from the start again. */
export function PlayBar() {
  const play = live("play").value;
  useEffect(() => {
    if (!running.value) return undefined;
    const timer = setInterval(() => send({ advance: RUN_EVERY / 1000 }), RUN_EVERY);
    return () => clearInterval(timer);
  }, [running.value]);
  if (!play) return null;
  const tick = mission.value?.tick ?? 0.05;
  const events = (live("offered").value ?? []).filter((it) => it.action === "event").map((it) => it.event);
  return html`<section class="bar playing" aria-label="time">
    <div class="buttons">
      <button type="button" class="plain" onClick=${() => send({ advance: tick })}>+1 tick</button>
      <button type="button" class="plain" onClick=${() => send({ advance: 1 })}>+1 s</button>
      <button type="button" class="plain" onClick=${() => send({ advance: 10 })}>+10 s</button>
      <button
        type="button"
        class="plain play"
        aria-pressed=${running.value ? "true" : "false"}
        onClick=${() => (running.value = !running.value)}
      ><${Icon} name=${running.value ? "pause" : "play"} /> ${running.value ? "Stop" : "Run"}</button>
      <button type="button" class="plain" onClick=${() => send({ reset: true })}>Start again</button>
      ${events.map(
        (name) => html`<button key=${name} type="button" class="plain event" onClick=${() => send({ event: name })}>
          <span class="cut">${name}</span>
        </button>`,
      )}
    </div>
    <span class="clock"><b>${clock(play.clock)}</b></span>
    ${failed.value && html`<span class="hint" role="status">${failed.value}</span>`}
  </section>`;
}
