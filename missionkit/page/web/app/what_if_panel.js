// What other values of the mission's parameters would have decided, computed by replay.
import { html, signal } from "./html.js";
import { number, seconds } from "./format.js";
import { tell } from "./connection.js";
import { mission } from "./flight_state.js";
import { post } from "./server.js";

const WAIT = 300; // ms after the last move of a slider
const chosen = signal({}); // parameter -> value
const found = signal(null); // the server's answer
const state = signal(""); // "", "computing …", or why it failed
let timer = 0;

export function WhatIfPanel() {
  const all = Object.entries(mission.value?.parameters ?? {});
  const parameters = all.filter(([, it]) => typeof it.value === "number");
  return html`<section class="panel what-if" aria-label="what if">
    <h2>What if <small>the same flight, other values</small></h2>
    <div class="scroll" role="group" tabindex="0" aria-label="parameters and decisions">
      <ul>
        ${parameters.map(([name, it]) => html`<${Slider} key=${name} name=${name} it=${it} />`)}
      </ul>
      ${!parameters.length && html`<p class="nothing">The mission has no parameter that is a number.</p>`}
      <p class="state-line" role="status">${state.value}</p>
      ${found.value && html`<${Decisions} it=${found.value} />`}
    </div>
  </section>`;
}

function Slider({ name, it }) {
  const now = chosen.value[name] ?? it.value;
  const [low, high] = range(it);
  return html`<li>
    <label>
      <span class="name cut" title=${it.text}>${name}</span>
      <output>${number(now)}${now === it.value ? "" : html` <small>flown ${number(it.value)}</small>`}</output>
      <input
        type="range"
        min=${low}
        max=${high}
        step=${(high - low) / 200}
        value=${now}
        onInput=${(event) => choose(name, Number(event.target.value), it.value)}
      />
    </label>
  </li>`;
}

function range({ value, min, max }) {
  const low = min ?? Math.min(0, 2 * value);
  const high = max ?? (value === 0 ? 1 : Math.max(0, 2 * value));
  return [low, high];
}

function choose(name, value, flown) {
  const { [name]: _, ...others } = chosen.value;
  chosen.value = value === flown ? others : { ...others, [name]: value };
  clearTimeout(timer);
  timer = setTimeout(compute, WAIT);
}

async function compute() {
  const set = chosen.value;
  if (!Object.keys(set).length) {
    found.value = null;
    state.value = "";
    return;
  }
  state.value = "computing …";
  try {
    const answer = await post("/api/what-if", { set, from: null }, 60000);
    if (set !== chosen.value) return;
    found.value = answer;
    state.value = "";
  } catch (error) {
    if (set === chosen.value) state.value = error.message;
  }
}

const SIGNS = { same: "=", earlier: "◀", later: "▶", new: "+", missing: "−" };

/** A decision without its time, which has a column of its own. */
function worded(decision) {
  return (decision ?? "–").replace(/^[\d.]+ s /, "");
}

function Decisions({ it }) {
  const until = it.evidence_until;
  return html`<table>
      <thead>
        <tr><th scope="col">at</th><th scope="col">decision</th><th scope="col">would be</th></tr>
      </thead>
      <tbody>
        ${it.rows.map(
          (row) => html`<tr class=${row.kind}>
            <td><button type="button" onClick=${() => tell({ t: "seek", at: row.at })}>${seconds(row.at)}</button></td>
            <td class="wrap">
              ${worded(row.was ?? row.now)}
              ${row.kind !== "same" && row.was && row.now && html`<br />now ${row.now}`}
            </td>
            <td>${SIGNS[row.kind]} ${row.kind}</td>
          </tr>`,
        )}
      </tbody>
    </table>
    ${until !== null &&
    until !== undefined &&
    html`<p class="evidence">
      From ${seconds(until)} on, commands would have differed: what was recorded later is no evidence.
    </p>`}`;
}
