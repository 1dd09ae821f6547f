// What a pilot looks at first: the state and its reason, then what may end the flight.
import { html } from "./html.js";
import { number, percent, seconds } from "./format.js";
import { live, mission, timeline } from "./flight_state.js";

export function TopBar() {
  return html`<header class="top">
    <h1 class="cut" title=${mission.value?.title ?? ""}>
      <span class="title">${mission.value?.title ?? "missionkit"}</span>
      <small>${sourceOf(mission.value)}</small>
    </h1>
    <${State} />
    <div class="chips">
      <${Mode} /><${Battery} /><${Link} /><${Recorder} /><${Cycle} /><${Pilot} />
    </div>
  </header>`;
}

function sourceOf(about) {
  if (!about) return "";
  return [about.source === "live" ? (about.dialect ?? "simulator") : about.source, about.version]
    .filter(Boolean)
    .join(" · ");
}

function State() {
  const state = live("state").value ?? "–";
  const since = live("entered_at").value;
  const now = live("now").value;
  const reason = [live("reason").value || lastReason(state, now), live("note").value].filter(Boolean).join("; ");
  return html`<div class="state" data-tick=${live("tick").value}>
    <div>
      <strong class="cut" title=${state} id="state">${state}</strong>
      <span class="time">${since === null || now === null ? "" : seconds(now - since)}</span>
    </div>
    <span class="reason cut" title=${reason}>${reason}</span>
  </div>`;
}

/** After a jump in a recording the timeline knows how the state was reached. */
function lastReason(state, now) {
  const last = timeline.value.fired.findLast((it) => it.at <= now + 1e-6);
  return last?.to === state ? last.reason : "";
}

/** A word and a value; `tone` "good", "warn" or "bad" adds a sign besides the colour. */
function Chip({ name, value, tone, more = "", title = "" }) {
  const sign = { warn: "▲ ", bad: "■ " }[tone] ?? "";
  return html`<span class=${`chip ${tone ?? ""}`} title=${`${name} ${value} ${more} ${title}`.trim()} data-chip=${name}>
    <small>${name}</small><b class="cut">${sign}${value}</b>${more && html`<i class="cut">${more}</i>`}
  </span>`;
}

function Mode() {
  if (live("pilot_flies").value) {
    return html`<${Chip} name="mode" value="pilot flies" tone="warn" />`;
  }
  const paused = live("paused").value;
  if (paused) return html`<${Chip} name="mode" value="paused" tone="warn" more=${paused} />`;
  const away = mission.value?.source === "live" && live("in_control").value === false;
  const more = away ? "not in control" : "";
  return html`<${Chip} name="mode" value=${live("mode").value ?? "–"} tone=${away ? "warn" : ""} more=${more} />`;
}

function Battery() {
  const battery = live("battery").value;
  if (!battery) return html`<${Chip} name="battery" value="–" />`;
  const left = battery.failsafe_in;
  const known = left !== null && left !== undefined;
  const tone = known && left < 60 ? "bad" : known && left < 180 ? "warn" : "";
  const more = known ? `failsafe in ${seconds(left)}` : "";
  const title = known ? `failsafe ${battery.failsafe ?? ""}` : "";
  return html`<${Chip} name="battery" value=${percent(battery.charge)} tone=${tone} more=${more} title=${title} />`;
}

function Link() {
  const age = live("link_age").value;
  if (age === null) return html`<${Chip} name="link" value="–" />`;
  const tone = age >= 2 ? "bad" : age >= 0.5 ? "warn" : "";
  return html`<${Chip} name="link" value=${seconds(age)} tone=${tone} />`;
}

function Recorder() {
  const recorder = live("recorder").value;
  if (!recorder || mission.value?.source !== "live") return null;
  const failed = recorder.startsWith("failed");
  const tone = failed ? "bad" : recorder === "off" ? "warn" : "";
  const [word, ...rest] = recorder.split(": ");
  return html`<${Chip} name="recorder" value=${word} tone=${tone} more=${rest.join(": ")} />`;
}

function Cycle() {
  const cycle = live("cycle_ms").value;
  const tick = 1000 * (mission.value?.tick ?? 0.05);
  if (!cycle) return null; // a replay takes none
  return html`<${Chip} name="cycle" value=${number(cycle, "ms")} tone=${cycle > tick ? "bad" : cycle > tick / 2 ? "warn" : ""} />`;
}

function Pilot() {
  const pilot = live("pilot").value;
  if (!pilot || mission.value?.source !== "live") return null;
  const silent = pilot.silent_for >= 3 ? `silent for ${seconds(pilot.silent_for)}` : "";
  const value = pilot.you ? "you" : (pilot.name ?? "nobody");
  return html`<${Chip} name="pilot" value=${value} tone=${silent ? "warn" : ""} more=${silent} />`;
}
