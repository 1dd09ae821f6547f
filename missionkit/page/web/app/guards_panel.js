// The guards of the active states: those nearest their threshold first.
import { html, signal, useEffect, useRef } from "./html.js";
import { number, seconds } from "./format.js";
import { fill, watchGuards } from "./guard_history.js";
import { GuardPlot } from "./guard_plot.js";
import { live, mission } from "./flight_state.js";
import { get } from "./server.js";
import { Sparkline } from "./sparkline.js";
import { VerdictMark, verdictOf, WORDS } from "./verdict_mark.js";

const SORT_EVERY = 1000; // ms: rows that jump cannot be read
const opened = signal(""); // the guard whose plot is shown

/** Keep the history of the guards; after a jump ask the server for what came before. */
export function keepHistory() {
  let waiting = 0;
  return watchGuards(() => {
    clearTimeout(waiting);
    waiting = setTimeout(refill, 200);
  });
}

async function refill() {
  const since = Math.max((live("now").value ?? 0) - 30, 0);
  for (const { name } of live("guards").value ?? []) {
    try {
      fill(name, await get("/api/series", { guard: name, since }));
    } catch {
      // the server has none of this guard: its history begins now
    }
  }
}

export function GuardsPanel() {
  const guards = live("guards").value ?? [];
  const order = useOrder(guards);
  const rows = order.map((name) => guards.find((it) => it.name === name)).filter(Boolean);
  return html`<section class="panel guards" aria-label="guards" data-tick=${live("tick").value}>
    <h2>Guards <small>nearest to their threshold first</small></h2>
    <ul class="rows" tabindex="0" aria-label="guards of the active states">
      ${rows.map((it) => html`<${Row} key=${it.name} guard=${it} />`)}
    </ul>
    ${!rows.length && html`<p class="nothing">No guard is watched in this state.</p>`}
  </section>`;
}

/** The server's order, taken over at most once a second and never under the pointer. */
function useOrder(guards) {
  const kept = useRef({ names: [], at: -Infinity });
  const names = guards.map((it) => it.name);
  const known = new Set(kept.current.names);
  const same = names.length === known.size && names.every((name) => known.has(name));
  const due = performance.now() - kept.current.at > SORT_EVERY;
  if (!same || (due && !document.querySelector(".guards .rows:hover"))) {
    kept.current = { names, at: performance.now() };
  }
  return kept.current.names;
}

function Row({ guard }) {
  const about = mission.value?.guards?.[guard.name];
  const unit = about?.unit ?? "";
  const verdict = verdictOf(guard.holds);
  const open = opened.value === guard.name;
  return html`<li class=${`guard ${verdict}`} data-guard=${guard.name} data-holds=${verdict}>
    <button
      type="button"
      class="line"
      aria-expanded=${open ? "true" : "false"}
      onClick=${() => (opened.value = open ? "" : guard.name)}
    >
      <${VerdictMark} verdict=${verdict} />
      <span class="name cut" title=${guard.name}>${guard.name}</span>
      <${Numbers} guard=${guard} unit=${unit} />
      <${MarginBar} guard=${guard} />
      <${Sparkline} name=${guard.name} />
    </button>
    ${!!guard.needs && guard.holds === true && html`<${HeldFor} guard=${guard} />`}
    ${verdict === "unknown" && guard.why && html`<p class="why cut" title=${guard.why}>${guard.why}</p>`}
    ${open && html`<${Opened} guard=${guard} about=${about} unit=${unit} />`}
  </li>`;
}

/** Value and threshold; a guard that has none says what it is instead. */
function Numbers({ guard, unit }) {
  if (guard.value === null || guard.value === undefined) return html`<span class="numbers small" data-value="">${WORDS[verdictOf(guard.holds)]}</span>`;
  return html`<span class="numbers">
    <span class="value" data-value=${guard.value}>${number(guard.value, unit)}</span>
    <span class="threshold" data-threshold=${guard.threshold ?? ""}>
      ${guard.threshold === null || guard.threshold === undefined ? "" : `of ${number(guard.threshold, unit)}`}
      ${guard.needs ? ` for ${seconds(guard.needs)}` : ""}
    </span>
  </span>`;
}

/** From the threshold in the middle to the right when it holds, to the left when it does not. */
function MarginBar({ guard }) {
  const known = guard.normal !== null && guard.normal !== undefined;
  const share = known ? Math.min(Math.max(guard.normal, -1), 1) : 0;
  return html`<span class="margin" aria-hidden="true" data-margin=${guard.margin ?? ""}>
    ${known && html`<span class="share" style=${{ transform: `scaleX(${share})` }}></span>`}
  </span>`;
}

/** How long it has held, of how long it must. */
function HeldFor({ guard }) {
  const held = Math.min(guard.held_for ?? 0, guard.needs);
  return html`<p class="held">
    <progress max="1" value=${held / guard.needs} aria-label=${`${guard.name} has held`}></progress>
    <span>held ${seconds(held)} of ${seconds(guard.needs)}</span>
  </p>`;
}

function Opened({ guard, about, unit }) {
  useEffect(() => {
    document.querySelector(".guard .opened")?.scrollIntoView({ block: "nearest" });
  }, []);
  return html`<div class="opened">
    ${about?.text && html`<p>${about.text}</p>`}
    <p>
      margin <b>${number(guard.margin, unit)}</b>${guard.why ? html`; ${guard.why}` : ""}
    </p>
    ${guard.value !== null && guard.value !== undefined && html`<${GuardPlot} name=${guard.name} />`}
  </div>`;
}
