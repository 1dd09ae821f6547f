// Starts the page.
import { effect, html, render } from "./html.js";
import { connect } from "./connection.js";
import { live, mission } from "./flight_state.js";
import { keepHistory } from "./guards_panel.js";
import { Page } from "./layout.js";

const TITLE = 60; // letters

keepHistory();
effect(() => {
  const words = [live("state").value, mission.value?.title, "missionkit"].filter(Boolean);
  document.title = words.map((it) => it.slice(0, TITLE)).join(" · ");
});
const place = document.querySelector("#page");
place.replaceChildren();
render(html`<${Page} />`, place);
connect();
