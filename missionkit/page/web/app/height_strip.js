// Height over the last minute, beside the map: the vehicle, its goal, and the fence's top.
import { html } from "./html.js";
import { useCanvas } from "./canvas_hook.js";
import { number } from "./format.js";
import { live, mission, track } from "./flight_state.js";
import { roundDistance } from "./map_view.js";
import { colour, prepared } from "./theme.js";

const SPAN = 60; // s
const EVERY = 150; // ms
const AXIS = 30; // px for the numbers
const BORDER = 14; // px above and below

export function HeightStrip() {
  const canvas = useCanvas(readHeights, draw, EVERY);
  const position = live("position").value;
  const word = mission.value?.over_ground === false ? "up" : "height";
  return html`<div class="strip">
    <div class="strip-now">
      <small>${word} m</small><b>${position ? number(-position[2]) : "–"}</b>
      <small>m/s</small><b>${number(speedOf(live("velocity").value))}</b>
      <small>± m</small><span>${number(live("position_sd").value)}</span>
    </div>
    <canvas class="height" ref=${canvas} role="img" aria-label="height over the last minute"></canvas>
  </div>`;
}

function speedOf(velocity) {
  return velocity ? Math.hypot(...velocity) : null;
}

function readHeights() {
  const position = live("position").value;
  const goal = live("goal").value;
  return {
    now: live("now").value ?? 0,
    height: position ? -position[2] : null,
    goal: goal ? -goal[2] : null,
    tops: (mission.value?.map?.fences ?? []).map((it) => it.top).filter((it) => it !== null && it !== undefined),
    track: track.value,
  };
}

function draw(canvas) {
  const { now, height, goal, tops, track: flown } = readHeights();
  const { context, width, height: high } = prepared(canvas);
  const recent = flown.points
    .map(([, , down], index) => [flown.at[index], -down])
    .filter(([at]) => at <= now && at >= now - SPAN);
  const seen = [0, ...recent.map(([, it]) => it), height, goal].filter((it) => it !== null);
  const [low, top] = [Math.min(...seen), Math.max(...seen, 2)];
  const y = (it) => high - BORDER - ((high - 2 * BORDER) * (it - low)) / (top - low);
  const x = (at) => width - 10 - ((width - AXIS - 10) * (now - at)) / SPAN;
  drawAxis(context, { low, top, y, width, room: high - 2 * BORDER });
  for (const it of tops.filter((value) => value <= top)) drawLevel(context, it, y, width, "fence");
  if (goal !== null) drawLevel(context, goal, y, width, "accent");
  context.strokeStyle = colour("track");
  context.lineWidth = 2;
  context.beginPath();
  for (const [at, it] of recent) context.lineTo(x(at), y(it));
  context.stroke();
  if (height === null) return;
  context.fillStyle = colour("accent");
  context.beginPath();
  context.arc(width - 10, y(height), 5, 0, 2 * Math.PI);
  context.fill();
}

function drawAxis(context, { low, top, y, width, room }) {
  context.font = "11px system-ui, sans-serif";
  context.textAlign = "right";
  context.textBaseline = "middle";
  const step = roundDistance(room / (top - low), 70);
  for (let it = Math.ceil(low / step) * step; it <= top + 1e-9; it += step) {
    context.fillStyle = colour("muted");
    context.fillText(String(Number(it.toPrecision(6))), AXIS - 6, y(it));
    context.fillStyle = colour("grid");
    context.fillRect(AXIS, y(it), width - AXIS, 1);
  }
}

function drawLevel(context, level, y, width, name) {
  context.strokeStyle = colour(name);
  context.lineWidth = 1.5;
  context.setLineDash([5, 4]);
  context.beginPath();
  context.moveTo(AXIS, y(level));
  context.lineTo(width, y(level));
  context.stroke();
  context.setLineDash([]);
}
