// What the mission promises: kept, broken, or still open.
import { html } from "./html.js";
import { number, seconds } from "./format.js";
import { live, mission } from "./flight_state.js";
import { VerdictMark } from "./verdict_mark.js";

const MARKS = { holds: "yes", broken: "no", open: "unknown" };

export function RequirementsPanel() {
  const rows = live("requirements").value ?? [];
  return html`<section class="panel requirements" aria-label="requirements">
    <h2>Requirements</h2>
    <ul class="rows" tabindex="0" aria-label="requirements">
      ${rows.map((it) => html`<${Requirement} key=${it.name} it=${it} />`)}
    </ul>
    ${!rows.length && html`<p class="nothing">The mission has none.</p>`}
  </section>`;
}

function Requirement({ it }) {
  const text = mission.value?.requirements?.find((each) => each.name === it.name)?.text ?? "";
  const more = [
    it.robustness === null || it.robustness === undefined ? "" : `by ${number(it.robustness)}`,
    it.deadline_in === null || it.deadline_in === undefined ? "" : `${seconds(it.deadline_in)} left`,
  ].filter(Boolean);
  return html`<li data-requirement=${it.name} title=${text}>
    <${VerdictMark} verdict=${MARKS[it.verdict]} word=${it.verdict} />
    <span class="name cut">${it.name}</span>
    <span class="more">${[it.verdict, ...more].join(", ")}</span>
  </li>`;
}
