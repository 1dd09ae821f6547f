// The chart: active states lit, arrows that fired flash, a click on an arrow asks it why.
import { effect, html, useEffect, useRef, useState } from "./html.js";
import { chart } from "./connection.js";
import { Icon } from "./icons.js";
import { lastFired, live, mission } from "./flight_state.js";
import { askWhy, WhyPanel } from "./why_panel.js";

const FLASH = 1500; // ms
const MARGIN = 14; // px around the drawing
const LEGIBLE = 0.8; // px on the screen for a px of the drawing: its smallest words are 12 px
const ZOOM = 1.25;
const LEAST = 0.2;
const MOST = 3;

export function ChartPanel() {
  const place = useRef(null);
  const [zoom, setZoom] = useState(LEGIBLE);
  useEffect(() => insert(place.current, chart.value), [chart.value]);
  useEffect(() => scale(place.current, zoom), [chart.value, zoom]);
  return html`<section class="panel chart-panel" aria-label="chart">
    <h2>Chart</h2>
    <div class="tools">
      <button type="button" aria-label="smaller chart" onClick=${() => setZoom(Math.max(zoom / ZOOM, LEAST))}>−</button>
      <button type="button" aria-label="larger chart" onClick=${() => setZoom(Math.min(zoom * ZOOM, MOST))}>+</button>
      <button type="button" onClick=${() => setZoom(fitting(place.current))}>Fit</button>
    </div>
    <div class="chart-scroll" role="group" tabindex="0" aria-label="chart, scrolls">
      <div class="chart-place" ref=${place} onClick=${onClick}></div>
    </div>
    <${Ways} />
    <${WhyPanel} />
  </section>`;
}

/** The ways out of the active states, and the failsafes: what a keyboard can reach. */
function Ways() {
  const active = live("active").value ?? [];
  const all = mission.value?.transitions ?? [];
  const ways = [
    ...all.filter((it) => active.includes(it.source)),
    ...all.filter((it) => it.source === null),
  ];
  const fired = new Set(lastFired.value.map((it) => it.id));
  return html`<ul class="ways" aria-label="ways out of the active states" tabindex="0">
    ${ways.map(
      (it) => html`<li key=${it.id}>
        <button type="button" class=${`way ${it.kind}${fired.has(it.id) ? " fired" : ""}`} onClick=${() => askWhy(it.id)}>
          <b class="cut">${it.source === null && html`<${Icon} name="shield" />`}→ ${it.to}</b>
          <span class="cut">${it.text}</span>
        </button>
      </li>`,
    )}
  </ul>`;
}

function onClick(event) {
  const arrow = event.target.closest("[data-transition]");
  if (arrow) askWhy(arrow.getAttribute("data-transition"));
}

/** Put the server's drawing into the page: as nodes, without what could run. */
function insert(place, text) {
  place.replaceChildren();
  if (!text) return undefined;
  const parsed = new DOMParser().parseFromString(text, "image/svg+xml");
  const svg = parsed.documentElement;
  if (svg.nodeName !== "svg") return undefined;
  for (const it of svg.querySelectorAll("script, style, foreignObject")) it.remove();
  place.append(document.importNode(svg, true));
  const drawing = place.firstElementChild;
  crop(drawing);
  widenArrows(drawing);
  return follow(drawing);
}

/** Show the chart alone: its title and its notes stand elsewhere on the page. */
function crop(svg) {
  svg.removeAttribute("width");
  svg.removeAttribute("height");
  const inner = svg.querySelector(":scope > g");
  if (!inner) return;
  for (const it of [...svg.children]) if (it !== inner && it.nodeName !== "defs") it.remove();
  const { x, y, width, height } = inner.getBBox();
  const moved = inner.transform.baseVal.consolidate()?.matrix ?? { e: 0, f: 0 };
  const corner = [x + moved.e - MARGIN, y + moved.f - MARGIN];
  svg.setAttribute("viewBox", [...corner, width + 2 * MARGIN, height + 2 * MARGIN].join(" "));
}

function sizeOf(place) {
  return place.firstElementChild?.viewBox.baseVal ?? { width: 1, height: 1 };
}

/** The scale at which all of the chart is seen. */
function fitting(place) {
  const { width, height } = sizeOf(place);
  const { clientWidth, clientHeight } = place.parentElement;
  return Math.max(Math.min(clientWidth / width, clientHeight / height), LEAST);
}

/** Draw it so large. */
function scale(place, zoom) {
  const svg = place.firstElementChild;
  if (!svg) return;
  const { width, height } = sizeOf(place);
  svg.style.width = `${zoom * width}px`;
  svg.style.height = `${zoom * height}px`;
  show(svg, "auto");
}

/** Scroll to the innermost active state, if it cannot be seen. */
function show(svg, behavior) {
  const name = live("state").peek();
  const group = [...svg.querySelectorAll("[data-state]")].findLast((it) => it.getAttribute("data-state") === name);
  const frame = svg.closest(".chart-scroll");
  if (!group || !frame) return;
  const [box, seen] = [group.getBoundingClientRect(), frame.getBoundingClientRect()];
  const hidden = box.top < seen.top || box.bottom > seen.bottom || box.left < seen.left || box.right > seen.right;
  if (!hidden) return;
  frame.scrollBy({
    left: (box.left + box.right - seen.left - seen.right) / 2,
    top: (box.top + box.bottom - seen.top - seen.bottom) / 2,
    behavior,
  });
}

/** A thin arrow is hard to hit: an unseen, wider one lies over it. */
function widenArrows(svg) {
  for (const path of svg.querySelectorAll("[data-transition] path")) {
    const wide = path.cloneNode();
    wide.setAttribute("class", "reach");
    wide.removeAttribute("marker-end");
    path.before(wide);
  }
}

/** Light the active states and let fired arrows flash. */
function follow(svg) {
  const states = [...svg.querySelectorAll("[data-state]")];
  const arrows = [...svg.querySelectorAll("[data-transition]")];
  const timers = new Set();
  const stops = [
    effect(() => {
      const active = new Set(live("active").value ?? []);
      for (const it of states) it.classList.toggle("active", active.has(it.getAttribute("data-state")));
      show(svg, matchMedia("(prefers-reduced-motion: reduce)").matches ? "auto" : "smooth");
    }),
    effect(() => {
      const ids = new Set(lastFired.value.map((it) => it.id));
      const lit = arrows.filter((it) => ids.has(it.getAttribute("data-transition")));
      for (const it of lit) it.classList.add("fired");
      if (!lit.length) return;
      const timer = setTimeout(() => {
        timers.delete(timer);
        for (const it of lit) it.classList.remove("fired");
      }, FLASH);
      timers.add(timer);
    }),
  ];
  return () => {
    for (const stop of stops) stop();
    for (const timer of timers) clearTimeout(timer);
  };
}
