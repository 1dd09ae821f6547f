// When each state was active, what fired, what went wrong, and how the requirements stood.
import { html } from "./html.js";
import { useCanvas } from "./canvas_hook.js";
import { tell } from "./connection.js";
import { clock, shortened } from "./format.js";
import { live, mission, timeline } from "./flight_state.js";
import { colour, prepared } from "./theme.js";

const EVERY = 200; // ms
const NAMES = 104; // px at the left
const LANE = 17; // px
const AXIS = 20; // px at the top
const LETTERS = 15;
const LISTED = 200;

export function TimelinePanel() {
  const { lanes, requirements } = timeline.value;
  const rows = [...statesOf(lanes), ...Object.keys(requirements ?? {})];
  const canvas = useCanvas(read, draw, EVERY);
  const height = AXIS + (rows.length + 1) * LANE;
  const seekable = mission.value?.source === "recording";
  return html`<section class="panel timeline-panel" aria-label="timeline">
    <h2>Timeline</h2>
    <div class="timeline-row">
      <div class="lanes" role="group" tabindex="0" aria-label="lanes of the states">
        <canvas
          ref=${canvas}
          class=${seekable ? "seekable" : ""}
          style=${{ height: `${height}px` }}
          role="img"
          aria-label="state lanes, transitions, problems and requirements over time"
          onClick=${(event) => seekable && seek(event)}
        ></canvas>
      </div>
      <${Events} seekable=${seekable} />
    </div>
  </section>`;
}

function statesOf(lanes) {
  return [...new Set(lanes.map((it) => it.state))];
}

function read() {
  return [timeline.value, live("now").value, live("playback").value];
}

function span() {
  const { end } = timeline.value;
  const now = live("now").value ?? 0;
  const duration = mission.value?.source === "recording" ? (live("playback").value?.end ?? end) : 0;
  return Math.max(duration ?? 0, now, 1);
}

function seek(event) {
  const { left, width } = event.currentTarget.getBoundingClientRect();
  const share = (event.clientX - left - NAMES) / (width - NAMES - 8);
  if (share >= 0) tell({ t: "seek", at: Math.min(share, 1) * span() });
}

function draw(canvas) {
  const [{ lanes, fired, problems, requirements }, now] = read();
  const { context, width, height } = prepared(canvas);
  const end = span();
  const x = (at) => NAMES + ((width - NAMES - 8) * at) / end;
  context.font = "12px system-ui, sans-serif";
  context.textBaseline = "middle";
  drawAxis(context, { end, x, height });
  const states = statesOf(lanes);
  const until = mission.value?.source === "recording" ? end : (now ?? end);
  const row = (at) => AXIS + at * LANE;
  states.forEach((state, at) => {
    const own = lanes.filter((it) => it.state === state);
    drawState(context, { state, own, y: row(at), x, until, at: now ?? 0, lit: live("active").peek() });
  });
  Object.entries(requirements ?? {}).forEach(([name, verdicts], at) =>
    drawRequirement(context, { name, verdicts, y: row(states.length + at), x, until }),
  );
  context.fillStyle = colour("muted");
  for (const { at } of fired) context.fillRect(x(at), AXIS - 5, 1, row(states.length) - AXIS + 5);
  for (const { at } of problems) drawProblem(context, x(at), row(states.length + Object.keys(requirements ?? {}).length));
  context.fillStyle = colour("accent");
  if (now !== null) context.fillRect(x(now) - 1, 2, 2, height - 4);
}

function drawAxis(context, { end, x, height }) {
  const steps = [1, 2, 5, 10, 20, 30, 60, 120, 300, 600, 1200, 1800, 3600];
  const step = steps.find((it) => x(it) - x(0) >= 64) ?? 7200;
  for (let at = 0; at <= end; at += step) {
    context.fillStyle = colour("muted");
    const text = `${Math.floor(at / 60)}:${String(Math.round(at % 60)).padStart(2, "0")}`;
    context.fillText(text, x(at) + 3, 8);
    context.fillStyle = colour("grid");
    context.fillRect(x(at), 0, 1, height);
  }
}

function drawName(context, name, y) {
  context.fillStyle = colour("ink");
  context.fillText(shortened(name, LETTERS), 4, y + LANE / 2, NAMES - 8);
}

function drawState(context, { state, own, y, x, until, at, lit }) {
  drawName(context, state, y);
  for (const { from, to } of own) {
    context.fillStyle = colour(lit?.includes(state) && at >= from && at <= (to ?? until) ? "accent" : "lane");
    context.fillRect(x(from), y + 2, Math.max(x(to ?? until) - x(from), 1.5), LANE - 4);
  }
}

const HEIGHTS = { holds: 4, broken: LANE - 4, open: 1.5 };
const COLOURS = { holds: "holds", broken: "bad", open: "muted" };

/** Broken is a thick bar, held a thin one, open a hairline. */
function drawRequirement(context, { name, verdicts, y, x, until }) {
  drawName(context, name, y);
  verdicts.forEach(({ at, verdict }, index) => {
    const to = verdicts[index + 1]?.at ?? until;
    const high = HEIGHTS[verdict];
    context.fillStyle = colour(COLOURS[verdict]);
    context.fillRect(x(at), y + (LANE - high) / 2, Math.max(x(to) - x(at), 1), high);
  });
}

function drawProblem(context, x, y) {
  context.fillStyle = colour("warn-ink");
  context.beginPath();
  for (const [dx, dy] of [[0, 3], [6, 13], [-6, 13]]) context.lineTo(x + dx, y + dy);
  context.closePath();
  context.fill();
}

/** Transitions and problems in words, the latest first. */
function Events({ seekable }) {
  const { fired, problems } = timeline.value;
  const now = live("now").value ?? Infinity;
  const all = [
    ...fired.map((it) => ({ at: it.at, kind: "fired", text: `${it.source} → ${it.to}`, more: it.reason })),
    ...problems.map((it) => ({ at: it.at, kind: "problem", text: it.says, more: it.times > 1 ? `${it.times} times` : "" })),
  ];
  const past = all.filter((it) => it.at <= now + 1e-6).sort((a, b) => b.at - a.at);
  return html`<ul class="events" tabindex="0" aria-label="events, the latest first">
    ${past.slice(0, LISTED).map(
      (it) => html`<${Event} key=${`${it.at} ${it.kind} ${it.text}`} it=${it} seekable=${seekable} />`,
    )}
  </ul>`;
}

function Event({ it, seekable }) {
  const words = html`<time>${clock(it.at)}</time>
    <b class="cut">${it.kind === "problem" ? "▲ " : ""}${it.text}</b><span class="cut">${it.more}</span>`;
  return html`<li class=${it.kind} title=${`${it.text} ${it.more}`}>
    ${seekable
      ? html`<button type="button" onClick=${() => tell({ t: "seek", at: it.at })}>${words}</button>`
      : html`<div>${words}</div>`}
  </li>`;
}
