// What is drawn on the map, from the ground up. Everything is in metres, north up.
import { number, shortened } from "./format.js";
import { roundDistance } from "./map_view.js";
import { colour } from "./theme.js";

const LABEL = 24; // letters
const FONT = "12px system-ui, sans-serif";

/** Draw all of `scene` on a canvas; `p` is a projection. */
export function drawMap(context, p, scene) {
  context.font = FONT;
  context.lineJoin = "round";
  drawGrid(context, p);
  for (const fence of scene.fences) drawFence(context, p, fence);
  for (const it of scene.obstacles) drawObstacle(context, p, it, scene.height);
  drawCells(context, p, scene.known);
  drawRanges(context, p, scene.ranges);
  drawTrack(context, p, scene.track, scene.now);
  for (const it of scene.markers) drawMarker(context, p, it);
  const tracked = new Set(scene.targets.map((it) => it.name));
  for (const it of scene.places) if (!tracked.has(it.name)) drawPlace(context, p, it);
  for (const it of scene.targets) drawTarget(context, p, it);
  drawGoal(context, p, scene.goal);
  drawVehicle(context, p, scene);
  drawScale(context, p);
}

function drawGrid(context, p) {
  const step = roundDistance(p.scale, 90);
  context.strokeStyle = colour("grid");
  context.lineWidth = 1;
  context.beginPath();
  for (let e = Math.ceil(p.east(0) / step) * step; p.x(e) < p.width; e += step) {
    context.moveTo(p.x(e), 0);
    context.lineTo(p.x(e), p.height);
  }
  for (let n = Math.ceil(p.north(p.height) / step) * step; p.y(n) > 0; n += step) {
    context.moveTo(0, p.y(n));
    context.lineTo(p.width, p.y(n));
  }
  context.stroke();
}

function trace(context, p, outline) {
  outline.forEach(([n, e], at) => (at ? context.lineTo(p.x(e), p.y(n)) : context.moveTo(p.x(e), p.y(n))));
  context.closePath();
}

function drawFence(context, p, { outline, holes = [] }) {
  context.strokeStyle = colour("fence");
  context.lineWidth = 2;
  context.setLineDash([10, 5]);
  context.beginPath();
  for (const ring of [outline, ...holes]) trace(context, p, ring);
  context.stroke();
  context.setLineDash([]);
}

/** What is lower than the vehicle by a metre is pale. */
function drawObstacle(context, p, it, height) {
  context.beginPath();
  if (it.shape === "round") context.arc(p.x(it.at[1]), p.y(it.at[0]), Math.max(it.radius * p.scale, 2), 0, 2 * Math.PI);
  else trace(context, p, it.outline);
  const below = height !== null && it.top !== null && it.top < height - 1;
  context.globalAlpha = below ? 0.35 : 0.9;
  context.fillStyle = colour("obstacle");
  context.fill();
  context.globalAlpha = 1;
  context.strokeStyle = colour("obstacle-edge");
  context.lineWidth = 1;
  context.stroke();
}

/** Blocked cells [n, e] of a map that was known before the flight. */
function drawCells(context, p, known) {
  if (!known?.blocked?.length) return;
  context.fillStyle = colour("known");
  const side = Math.max(known.resolution * p.scale, 1);
  for (const [n, e] of known.blocked) {
    context.save();
    context.translate(p.x(e), p.y(n));
    context.rotate(known.turned ?? 0);
    context.fillRect(-side / 2, -side / 2, side, side);
    context.restore();
  }
}

function drawRanges(context, p, ranges) {
  context.fillStyle = colour("range");
  for (const [n, e] of ranges) context.fillRect(p.x(e) - 1.5, p.y(n) - 1.5, 3, 3);
}

/** The part until now is strong, the rest of a recording pale. */
function drawTrack(context, p, { at, points }, now) {
  if (points.length < 2) return;
  const passed = now === null ? points.length : at.findIndex((time) => time > now);
  const end = passed < 0 ? points.length : passed;
  context.strokeStyle = colour("track");
  context.lineWidth = 2;
  context.globalAlpha = 0.3;
  drawPath(context, p, points.slice(Math.max(end - 1, 0)));
  context.globalAlpha = 1;
  drawPath(context, p, points.slice(0, end));
}

function drawPath(context, p, points) {
  context.beginPath();
  points.forEach(([n, e], at) => (at ? context.lineTo(p.x(e), p.y(n)) : context.moveTo(p.x(e), p.y(n))));
  context.stroke();
}

function drawLabel(context, p, text, n, e, above = 10) {
  const shown = shortened(text, LABEL);
  const wide = context.measureText(shown).width;
  const x = Math.min(Math.max(p.x(e) - wide / 2, 2), p.width - wide - 2);
  context.lineWidth = 3;
  context.strokeStyle = colour("paper");
  context.strokeText(shown, x, p.y(n) - above);
  context.fillStyle = colour("ink");
  context.fillText(shown, x, p.y(n) - above);
}

function drawMarker(context, p, { at: [n, e], size }) {
  const side = Math.max((size ?? 0.4) * p.scale, 6);
  context.fillStyle = colour("paper");
  context.strokeStyle = colour("ink");
  context.lineWidth = 1.5;
  context.fillRect(p.x(e) - side / 2, p.y(n) - side / 2, side, side);
  context.strokeRect(p.x(e) - side / 2, p.y(n) - side / 2, side, side);
}

function drawPlace(context, p, { name, at: [n, e] }) {
  context.strokeStyle = colour("ink");
  context.lineWidth = 1.5;
  context.beginPath();
  context.arc(p.x(e), p.y(n), 5, 0, 2 * Math.PI);
  context.stroke();
  drawLabel(context, p, name, n, e);
}

/** One and two standard deviations; dashed while it is not seen. */
function drawTarget(context, p, { name, at: [n, e], sd, seen_ago: ago }) {
  context.strokeStyle = colour("target");
  context.lineWidth = 1.5;
  context.setLineDash(ago === null || ago === undefined || ago > 1 ? [5, 4] : []);
  for (const many of [1, 2]) {
    context.beginPath();
    context.arc(p.x(e), p.y(n), Math.max(many * (sd ?? 0) * p.scale, 3 * many), 0, 2 * Math.PI);
    context.stroke();
  }
  context.setLineDash([]);
  drawLabel(context, p, name, n, e, 14);
}

function drawGoal(context, p, goal) {
  if (!goal) return;
  const [x, y] = [p.x(goal[1]), p.y(goal[0])];
  context.strokeStyle = colour("accent");
  context.lineWidth = 2;
  context.beginPath();
  for (const [dx, dy] of [[1, 0], [-1, 0], [0, 1], [0, -1]]) {
    context.moveTo(x + 4 * dx, y + 4 * dy);
    context.lineTo(x + 11 * dx, y + 11 * dy);
  }
  context.stroke();
}

function drawVehicle(context, p, { position, velocity, yaw, sd }) {
  if (!position) return;
  const [x, y] = [p.x(position[1]), p.y(position[0])];
  context.fillStyle = colour("accent");
  if (sd) {
    context.globalAlpha = 0.18;
    context.beginPath();
    context.arc(x, y, Math.max(2 * sd * p.scale, 8), 0, 2 * Math.PI);
    context.fill();
    context.globalAlpha = 1;
  }
  if (velocity) {
    context.strokeStyle = colour("accent");
    context.lineWidth = 2;
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(p.x(position[1] + 2 * velocity[1]), p.y(position[0] + 2 * velocity[0]));
    context.stroke();
  }
  context.save();
  context.translate(x, y);
  context.rotate(yaw ?? 0);
  context.beginPath();
  for (const [dx, dy] of [[0, -13], [9, 10], [0, 5], [-9, 10]]) context.lineTo(dx, dy);
  context.closePath();
  context.strokeStyle = colour("paper");
  context.lineWidth = 3;
  context.stroke();
  context.fill();
  context.restore();
}

function drawScale(context, p) {
  const metres = roundDistance(p.scale, 110);
  const [x, y, wide] = [12, p.height - 14, metres * p.scale];
  context.strokeStyle = colour("ink");
  context.fillStyle = colour("ink");
  context.lineWidth = 2;
  context.beginPath();
  context.moveTo(x, y - 5);
  context.lineTo(x, y);
  context.lineTo(x + wide, y);
  context.lineTo(x + wide, y - 5);
  context.stroke();
  context.fillText(number(metres, "m"), x + 4, y - 6);
}
