// Signs drawn as shapes: a font may lack them.
import { html } from "./html.js";

const SHAPES = {
  play: "M6 4l14 8-14 8z",
  pause: "M6 4h4.5v16H6zM13.5 4H18v16h-4.5z",
  next: "M4 5l11 7-11 7zM17 5h3v14h-3z",
  before: "M20 5L9 12l11 7zM4 5h3v14H4z",
  close: "M5 7l2-2 5 5 5-5 2 2-5 5 5 5-2 2-5-5-5 5-2-2 5-5z",
  shield: "M12 2l8 3v6c0 5-3.4 9-8 11-4.6-2-8-6-8-11V5z",
};

/** A sign without words: its button says what it does. */
export function Icon({ name }) {
  return html`<svg class="icon" viewBox="0 0 24 24" aria-hidden="true"><path d=${SHAPES[name]} /></svg>`;
}
