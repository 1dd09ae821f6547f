// Colours for what is drawn on a canvas: those of the style sheet, light or dark.
import { signal } from "./html.js";

const dark = matchMedia("(prefers-color-scheme: dark)");
let colours = {};
export const theme = signal(dark.matches ? "dark" : "light");

dark.addEventListener("change", () => {
  colours = {};
  theme.value = dark.matches ? "dark" : "light";
});

/** The colour of a custom property, "ink" for --ink. */
export function colour(name) {
  colours[name] ??= getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
  return colours[name];
}

/** Fit a canvas to its box at the screen's resolution; returns the context and the size in px. */
export function prepared(canvas) {
  const { clientWidth: width, clientHeight: height } = canvas;
  const ratio = window.devicePixelRatio || 1;
  const [wide, high] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== wide || canvas.height !== high) Object.assign(canvas, { width: wide, height: high });
  const context = canvas.getContext("2d");
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.clearRect(0, 0, width, height);
  return { context, width, height };
}
