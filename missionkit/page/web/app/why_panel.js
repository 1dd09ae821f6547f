// Why a transition has fired, or has not: its conditions, what stands before it, what comes next.
import { html, signal, useEffect } from "./html.js";
import { number, seconds } from "./format.js";
import { Icon } from "./icons.js";
import { live, mission } from "./flight_state.js";
import { get } from "./server.js";
import { VerdictMark, verdictOf } from "./verdict_mark.js";

const ASK_EVERY = 1000; // ms while it is open

const asked = signal(""); // id of the transition
const found = signal(null); // the server's answer
const failed = signal("");
let askedAt = null; // time of the flight

/** Open the panel for a transition. */
export function askWhy(id) {
  found.value = null;
  failed.value = "";
  asked.value = id;
}

/** Ask again; a recording that stands still has nothing new to say. */
async function refresh(id) {
  const now = live("now").value;
  if (mission.value?.source === "recording" && found.value && now === askedAt) return;
  askedAt = now;
  const at = mission.value?.source === "recording" ? { at: now ?? 0 } : {};
  try {
    const answer = await get("/api/why", { transition: id, ...at });
    if (asked.value === id) found.value = answer;
  } catch (error) {
    if (asked.value === id) failed.value = error.message;
  }
}

export function WhyPanel() {
  const id = asked.value;
  useEffect(() => {
    if (!id) return undefined;
    refresh(id);
    const timer = setInterval(() => refresh(id), ASK_EVERY);
    const close = (event) => event.key === "Escape" && (asked.value = "");
    addEventListener("keydown", close);
    document.querySelector(".why-panel button")?.focus();
    return () => {
      clearInterval(timer);
      removeEventListener("keydown", close);
    };
  }, [id]);
  if (!id) return null;
  const way = mission.value?.transitions.find((it) => it.id === id);
  return html`<aside class="why-panel" aria-label="why">
    <header>
      <h3 class="cut" title=${way?.text}>${way?.source ?? "any state"} → ${way?.to}</h3>
      <button type="button" aria-label="close" onClick=${() => (asked.value = "")}><${Icon} name="close" /></button>
    </header>
    <div class="why-body" role="group" tabindex="0" aria-label="answer">
      <p class="quote">${way?.text}</p>
      ${failed.value && html`<p class="refused">${failed.value}</p>`}
      ${found.value && html`<${Answer} it=${found.value} />`}
    </div>
  </aside>`;
}

function Answer({ it }) {
  const next = it.if_nothing_changes;
  return html`<p class="answer">${it.text.split("\n")[0]}</p>
    ${!!it.conjuncts?.length &&
    html`<ul class="conjuncts">
      ${it.conjuncts.map((each) => html`<${Conjunct} key=${each.guard} it=${each} />`)}
    </ul>`}
    ${!!it.before?.length &&
    html`<h4>Before it</h4>
      <ul class="before">${it.before.map((text) => html`<li>${text}</li>`)}</ul>`}
    ${next &&
    html`<h4>If nothing changes</h4>
      <p class="next">in <b>${seconds(next.in)}</b>: ${next.evidence}</p>`}
    ${it.smallest_change &&
    html`<h4>Smallest change</h4>
      <p>${it.smallest_change.text}${it.smallest_change.verified ? " (verified by replay)" : ""}</p>`}`;
}

function Conjunct({ it }) {
  const verdict = verdictOf(it.holds);
  const numbers = it.value !== null && it.value !== undefined;
  const unit = mission.value?.guards?.[it.guard]?.unit ?? "";
  const closest = it.closest?.margin !== null && it.closest?.margin !== undefined;
  return html`<li>
    <${VerdictMark} verdict=${verdict} />
    <div>
      <b class="wrap">${it.guard}</b>
      ${numbers && html` <span>${number(it.value, unit)} of ${number(it.threshold, unit)}</span>`}
      ${it.why && html`<p>${it.why}</p>`}
      ${closest &&
      html`<p class="closest">closest: margin ${number(it.closest.margin, unit)} at ${seconds(it.closest.at)}</p>`}
    </div>
  </li>`;
}
