// Where the panels are: side by side on a wide screen, one at a time behind tabs on a narrow one.
import { html, signal } from "./html.js";
import { ActionBar } from "./action_bar.js";
import { Banner, NoWayIn } from "./banner.js";
import { CameraPanel } from "./camera_panel.js";
import { ChartPanel } from "./chart_panel.js";
import { freshness, refused, session } from "./connection.js";
import { mission } from "./flight_state.js";
import { GuardsPanel } from "./guards_panel.js";
import { MapPanel } from "./map_panel.js";
import { PilotDialog } from "./pilot_dialog.js";
import { PlayBar, PlayPanel } from "./play_panel.js";
import { PlaybackBar } from "./playback_bar.js";
import { RequirementsPanel } from "./requirements_panel.js";
import { TimelinePanel } from "./timeline_panel.js";
import { TopBar } from "./top_bar.js";
import { WhatIfPanel } from "./what_if_panel.js";

const WIDE = matchMedia("(min-width: 1100px)");
const wide = signal(WIDE.matches);
WIDE.addEventListener("change", () => (wide.value = WIDE.matches));

const BARS = { recording: PlaybackBar, play: PlayBar, live: ActionBar };

export function Page() {
  if (refused.value && !session.value) return html`<${NoWayIn} />`;
  const source = mission.value?.source;
  const Bar = BARS[source];
  const late = freshness.value === "fresh" ? "" : ` ${freshness.value}`;
  return html`<div class=${`page ${wide.value ? "wide" : "narrow"}${late}`} data-freshness=${freshness.value}>
    <${TopBar} />
    <${Banner} />
    ${wide.value ? html`<${Wide} source=${source} />` : html`<${Narrow} source=${source} />`}
    ${source === "live" && html`<${PilotDialog} />`}
    ${Bar ? html`<${Bar} />` : html`<section class="bar"></section>`}
  </div>`;
}

function Wide({ source }) {
  return html`<main class=${`grid ${source ?? ""}`}>
    <div class="left">
      ${source === "play"
        ? html`<${PlayPanel} /><${RequirementsPanel} />`
        : html`<${MapPanel} /><${Seen} />`}
    </div>
    <${ChartPanel} />
    <${Side} source=${source} />
    <${TimelinePanel} />
  </main>`;
}

function Seen() {
  const promises = !!mission.value?.requirements?.length;
  return html`<div class=${`seen-row${promises ? "" : " alone"}`}>
    <${CameraPanel} />
    ${promises && html`<${RequirementsPanel} />`}
  </div>`;
}

const side = signal("guards");

/** Guards, and below another tab what is particular to the source. */
function Side({ source }) {
  if (source !== "recording") return html`<div class="side"><${GuardsPanel} /></div>`;
  return html`<div class="side">
    <${Tabs} names=${["guards", "what if"]} chosen=${side} label="guards or what if" />
    ${side.value === "guards" ? html`<${GuardsPanel} />` : html`<${WhatIfPanel} />`}
  </div>`;
}

const PANELS = {
  map: MapPanel,
  chart: ChartPanel,
  guards: GuardsPanel,
  camera: Seen,
  time: TimelinePanel,
  set: PlayPanel,
  promises: RequirementsPanel,
  "what if": WhatIfPanel,
};
const TABS = {
  live: ["map", "chart", "guards", "camera", "time"],
  recording: ["map", "chart", "guards", "camera", "time", "what if"],
  play: ["set", "chart", "guards", "promises", "time"],
};
const tab = signal("");

function Narrow({ source }) {
  if (!source) return html`<main class="single"></main>`;
  const names = TABS[source];
  if (!names.includes(tab.value)) tab.value = names[0];
  const Panel = PANELS[tab.value];
  return html`<main class="single">
    <${Tabs} names=${names} chosen=${tab} label="panels" />
    <div class="one" role="tabpanel" aria-label=${tab.value}><${Panel} /></div>
  </main>`;
}

/** Tabs that the arrow keys move between. */
function Tabs({ names, chosen, label }) {
  const move = (event) => {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const at = (names.indexOf(chosen.value) + step + names.length) % names.length;
    chosen.value = names[at];
    event.currentTarget.children[at].focus();
  };
  return html`<div class="tabs" role="tablist" aria-label=${label} onKeyDown=${move}>
    ${names.map(
      (name) => html`<button
        key=${name}
        type="button"
        role="tab"
        aria-selected=${chosen.value === name ? "true" : "false"}
        tabindex=${chosen.value === name ? 0 : -1}
        onClick=${() => (chosen.value = name)}
      >${name}</button>`,
    )}
  </div>`;
}
