// Holds, does not, unknown: told by shape as well as by colour.
import { html } from "./html.js";

const SHAPES = {
  yes: html`<circle cx="8" cy="8" r="7.5" /><path class="sign" d="M4.4 8.3l2.5 2.6 4.8-5.4" />`,
  no: html`<rect x="1.5" y="1.5" width="13" height="13" rx="2" /><path class="sign" d="M5 5l6 6M11 5l-6 6" />`,
  unknown: html`<path d="M8 .4L15.6 8 8 15.6.4 8z" /><path class="sign" d="M6.2 6.4q0-1.9 1.8-1.9 1.9 0 1.9 1.7 0 1.1-1.2 1.6-.7.4-.7 1.2M8 11.2v.3" />`,
};

export const WORDS = { yes: "holds", no: "does not hold", unknown: "unknown" };

/** "yes", "no" or "unknown" of a guard's `holds`. */
export function verdictOf(holds) {
  return holds === true ? "yes" : holds === false ? "no" : "unknown";
}

/** The mark of a verdict; `word` replaces what a screen reader says. */
export function VerdictMark({ verdict, word }) {
  return html`<svg class=${`mark ${verdict}`} viewBox="0 0 16 16" role="img" aria-label=${word ?? WORDS[verdict]}>
    ${SHAPES[verdict]}
  </svg>`;
}
