// The map: a canvas in metres that is dragged, zoomed, fitted, and follows the vehicle.
import { html, signal, useEffect } from "./html.js";
import { useCanvas } from "./canvas_hook.js";
import { live, mission, track } from "./flight_state.js";
import { HeightStrip } from "./height_strip.js";
import { drawMap } from "./map_drawing.js";
import { drawTiles } from "./map_tiles.js";
import { fit, makeView, projection, zoomAt } from "./map_view.js";
import { prepared } from "./theme.js";

const EVERY = 80; // ms
const STEP = 60; // px that an arrow key moves the map
const view = makeView();
const moved = signal(0); // counts changes of the view, and tiles that arrived

const touch = () => (moved.value = moved.peek() + 1);

export function MapPanel() {
  const canvas = useCanvas(readScene, draw, EVERY);
  useEffect(() => mouse(canvas.current), []);
  const zoom = (factor) => zoomMiddle(canvas.current, factor);
  return html`<section class="panel map-panel" aria-label="map">
    <h2>Map</h2>
    <div class="tools">
      <button type="button" aria-label="zoom out" onClick=${() => zoom(1 / 1.5)}>−</button>
      <button type="button" aria-label="zoom in" onClick=${() => zoom(1.5)}>+</button>
      <button type="button" onClick=${() => showAll(canvas.current)}>Fit</button>
      <${Follow} />
    </div>
    <div class="map-row">
      <canvas
        class="map"
        ref=${canvas}
        tabindex="0"
        role="img"
        aria-label="map, north up; arrow keys move it, plus and minus zoom"
        onKeyDown=${(event) => byKey(event, canvas.current)}
      ></canvas>
      <${HeightStrip} />
    </div>
  </section>`;
}

function Follow() {
  moved.value;
  return html`<button
    type="button"
    aria-pressed=${view.follow ? "true" : "false"}
    onClick=${() => {
      view.follow = !view.follow;
      touch();
    }}
  >Follow</button>`;
}

function readScene() {
  moved.value;
  const { obstacles = [], markers = [], places = [], fences = [], known = null } = mission.value?.map ?? {};
  const position = live("position").value;
  return {
    obstacles,
    markers,
    places,
    fences,
    known,
    position,
    height: position && mission.value?.over_ground ? -position[2] : null,
    velocity: live("velocity").value,
    yaw: live("yaw").value,
    sd: live("position_sd").value,
    goal: live("goal").value,
    targets: live("targets").value ?? [],
    ranges: live("obstacles").value ?? [],
    track: track.value,
    now: mission.value?.source === "recording" ? live("now").value : null,
  };
}

function draw(canvas) {
  const scene = readScene();
  const { context, width, height } = prepared(canvas);
  if (!view.fitted && mission.value && scene.position) {
    fit(view, interesting(scene), width, height);
    view.fitted = true;
  }
  if (view.follow && scene.position) view.centre = scene.position.slice(0, 2);
  const p = projection(view, width, height);
  drawTiles(context, p, mission.value ?? {}, touch);
  drawMap(context, p, scene);
}

/** What should be seen at first: not the fence, which may be far away. */
function interesting(scene) {
  const all = [...scene.places, ...scene.targets, ...scene.markers].map((it) => it.at);
  const round = scene.obstacles.flatMap((it) => it.outline ?? [it.at]);
  const points = [...all, ...round, ...scene.track.points, scene.position, scene.goal].filter(Boolean);
  return points.length > 1 ? points : [...points, ...scene.fences.flatMap((it) => it.outline)];
}

function showAll(canvas) {
  view.follow = false;
  fit(view, interesting(readScene()), canvas.clientWidth, canvas.clientHeight);
  touch();
}

function zoomMiddle(canvas, factor) {
  const { clientWidth: width, clientHeight: height } = canvas;
  zoomAt(view, factor, width / 2, height / 2, width, height);
  touch();
}

function byKey(event, canvas) {
  const step = STEP / view.scale;
  const moves = { ArrowUp: [step, 0], ArrowDown: [-step, 0], ArrowLeft: [0, -step], ArrowRight: [0, step] };
  if (event.key === "+" || event.key === "-") zoomMiddle(canvas, event.key === "+" ? 1.5 : 1 / 1.5);
  else if (moves[event.key]) move(...moves[event.key]);
  else return;
  event.preventDefault();
}

function move(north, east) {
  view.follow = false;
  view.centre = [view.centre[0] + north, view.centre[1] + east];
  touch();
}

/** Drag with one pointer, pinch with two, zoom with the wheel. */
function mouse(canvas) {
  const down = new Map();
  const place = (event) => [event.offsetX, event.offsetY];
  const gap = () => {
    const [[x, y], [u, v]] = [...down.values()];
    return Math.hypot(x - u, y - v) || 1;
  };
  const handlers = {
    pointerdown(event) {
      canvas.setPointerCapture(event.pointerId);
      down.set(event.pointerId, place(event));
    },
    pointermove(event) {
      const before = down.get(event.pointerId);
      if (!before) return;
      const wide = down.size === 2 ? gap() : 0;
      const [x, y] = place(event);
      down.set(event.pointerId, [x, y]);
      if (down.size === 2) zoomAt(view, gap() / wide, x, y, canvas.clientWidth, canvas.clientHeight);
      else return move((y - before[1]) / view.scale, (before[0] - x) / view.scale);
      touch();
    },
    pointerup: (event) => down.delete(event.pointerId),
    pointercancel: (event) => down.delete(event.pointerId),
    wheel(event) {
      event.preventDefault();
      zoomAt(view, 1.2 ** (-event.deltaY / 100), ...place(event), canvas.clientWidth, canvas.clientHeight);
      touch();
    },
  };
  for (const [name, handle] of Object.entries(handlers)) canvas.addEventListener(name, handle, { passive: false });
  return undefined;
}
