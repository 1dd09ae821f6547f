// The last camera image, with what was detected in it drawn over it.
import { effect, html, signal, useEffect, useRef } from "./html.js";
import { shortened, percent } from "./format.js";
import { live } from "./flight_state.js";
import { colour, prepared } from "./theme.js";

const EVERY = 150; // ms between two images at least
const shown = signal(null); // the `image` that is in the page, and its detections

export function CameraPanel() {
  const picture = useRef(null);
  const canvas = useRef(null);
  useEffect(() => loadImages(picture.current), []);
  useEffect(() => effect(() => drawOver(canvas.current, shown.value)), []);
  const image = shown.value;
  return html`<section class="panel camera-panel" aria-label="camera">
    <h2>Camera</h2>
    <div class="camera">
      <img ref=${picture} alt="camera image" class=${image ? "" : "hidden"} width="640" height="480" />
      <canvas ref=${canvas} aria-hidden="true"></canvas>
      ${!image && html`<p class="nothing">No image.</p>`}
    </div>
    <p class="seen cut">${sentence(image)}</p>
  </section>`;
}

function sentence(image) {
  if (!image) return "";
  const names = image.detections.map((it) => it.name);
  return names.length ? `sees ${names.join(", ")}` : "sees nothing it knows";
}

/** Load one image after another; what comes in between is left out. */
function loadImages(picture) {
  let busy = false;
  let wanted = null;
  let last = -Infinity;
  const next = () => {
    const image = wanted;
    if (busy || !image || image.n === shown.peek()?.n) return;
    const wait = last + EVERY - performance.now();
    if (wait > 0) return void setTimeout(next, wait);
    busy = true;
    last = performance.now();
    const done = (loaded) => {
      busy = false;
      shown.value = loaded ? { ...image, detections: live("detections").peek() ?? [] } : null;
      next();
    };
    picture.onload = () => done(true);
    picture.onerror = () => done(false);
    picture.src = `/api/image.jpg?n=${encodeURIComponent(image.n)}`;
  };
  return effect(() => {
    wanted = live("image").value;
    if (!wanted) shown.value = null;
    next();
  });
}

function drawOver(canvas, image) {
  const { context, width, height } = prepared(canvas);
  if (!image?.width) return;
  const scale = Math.min(width / image.width, height / image.height);
  const [left, top] = [(width - scale * image.width) / 2, (height - scale * image.height) / 2];
  context.font = "bold 12px system-ui, sans-serif";
  for (const it of image.detections) {
    const corners = (it.corners ?? cornersOf(it.box)).map(([x, y]) => [left + scale * x, top + scale * y]);
    if (corners.length) drawDetection(context, it, corners);
  }
}

function cornersOf(box) {
  if (!box) return [];
  const [x, y, wide, high] = box;
  return [[x, y], [x + wide, y], [x + wide, y + high], [x, y + high]];
}

function drawDetection(context, { name, score }, corners) {
  context.beginPath();
  for (const [x, y] of corners) context.lineTo(x, y);
  context.closePath();
  for (const [line, width] of [["#000", 4], [colour("seen"), 2]]) {
    context.strokeStyle = line;
    context.lineWidth = width;
    context.stroke();
  }
  const words = shortened(score === null || score === undefined ? name : `${name} ${percent(score)}`, 30);
  const room = context.canvas.clientWidth - context.measureText(words).width - 4;
  const x = Math.max(Math.min(...corners.map((it) => it[0]), room), 2);
  const y = Math.min(...corners.map((it) => it[1])) - 6;
  context.lineWidth = 3;
  context.strokeStyle = "#000";
  context.strokeText(words, x, Math.max(y, 12));
  context.fillStyle = colour("seen");
  context.fillText(words, x, Math.max(y, 12));
}
