"""How quick the page is, and what it costs: `python -m studies.page`. Needs chromium."""

from __future__ import annotations

import argparse
import contextlib
import json
import shutil
import subprocess
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from playwright.sync_api import Browser, CDPSession, Page, sync_playwright
from websockets.sync.client import connect

MISSION = """\
missionkit: 1
mission: to-and-fro
camera: {use: none}
targets: {far: {position: [10, 5, -4]}, near: {position: [0, 0, -4]}}
failsafes:
  - {name: battery, when: {use: battery_below, floor: 0.05}, unknown: ignore, to: land}
initial: idle
states:
  idle: {kind: idle, behavior: {use: take_off, height: 4}, transitions: [{to: out, when: done}]}
  out:
    kind: gps
    behavior: {use: go_to, target: far, speed: 3}
    transitions: [{to: back, when: done}, {to: land, event: down}]
  back:
    kind: gps
    behavior: {use: go_to, target: near, speed: 3}
    transitions: [{to: out, when: done}, {to: land, event: down}]
  land: {kind: land}
"""
PAGE = """# Study: the live page

A rehearsal in real time with its page, {viewers} browsers in one Chromium, and one reader that
opens the live messages and never reads them.

    {command}

| | median | p95 |
| --- | --- | --- |
| tick to the page (ms) | {tick[0]:.0f} | {tick[1]:.0f} |
| release of HOLD or CONTINUE to the tick that takes it, shown (ms) | {act[0]:.0f} | {act[1]:.0f} |

- First contentful paint: {paint:.0f} ms. Ticks measured: {ticks}. Actions: {acts}.
- Heap of the page after {minutes:g} minutes: {grown:+.2f} MB (after a garbage collection).
- Requests to another host: {foreign}.
"""
ARGUMENTS = ("--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run")
WATCH = """() => {
  window.ticks = [];
  const state = document.querySelector(".state");
  new MutationObserver(() => window.ticks.push([Number(state.dataset.tick), Date.now()]))
    .observe(state, {attributes: true, attributeFilter: ["data-tick"]});
}"""
HEAP = "JSHeapUsedSize"


@contextlib.contextmanager
def flying(folder: Path) -> Iterator[str]:
    """Fly in real time with a page; yield the address of the pilot."""
    mission = folder / "mission.yaml"
    mission.write_text(MISSION, encoding="utf-8")
    order = ("run", str(mission), "--speed", "1", "--headless", "--page", "--out", str(folder))
    process = subprocess.Popen(  # noqa: S603 - this program
        [sys.executable, "-m", "missionkit", *order],
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
    )
    try:
        assert process.stdout is not None  # noqa: S101 - asked for above
        line = next(it for it in process.stdout if "#token=" in it)
        yield next(it for it in line.split() if it.startswith("http"))
    finally:
        process.terminate()
        process.wait(30)


class Watched:
    """One page whose ticks are timed."""

    def __init__(self, page: Page) -> None:
        self.page = page
        self.sent_at: dict[int, float] = {}  # tick -> ms, when it was computed
        page.on("websocket", lambda it: it.on("framereceived", self._frame))

    def _frame(self, data: str | bytes) -> None:
        message = json.loads(data)
        if "tick" in message and "at_ms" in message:
            self.sent_at[message["tick"]] = message["at_ms"]

    def open(self, address: str) -> None:
        """Open it, and begin to time."""
        self.page.goto(address)
        self.page.locator(".hold, .viewer").first.wait_for()
        self.page.evaluate(WATCH)

    def delays(self) -> list[float]:
        """Return how long (ms) each tick took to be shown."""
        shown = self.page.evaluate("() => window.ticks.splice(0)")
        return [at - self.sent_at[tick] for tick, at in shown if tick in self.sent_at]


def acted(page: Page, which: str) -> float:
    """Hold a button, and return the time (ms) from its release to a tick that says it is taken."""
    before = page.locator(".stages").inner_text()
    page.bring_to_front()
    page.locator(f"{which}[aria-disabled='false']").wait_for()
    box = page.locator(which).bounding_box()
    if box is None:
        raise RuntimeError(f"{which} is not on the page")
    page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    page.mouse.down()
    page.wait_for_timeout(600)
    page.evaluate(
        """before => { window.taken = null; const began = {at: null};
        addEventListener("pointerup", () => began.at = Date.now(), {once: true, capture: true});
        const seen = new MutationObserver(() => {
          const text = document.querySelector(".stages").innerText;
          if (text !== before && /taken at tick/.test(text)) {
            window.taken = Date.now() - began.at; seen.disconnect(); } });
        seen.observe(document.querySelector(".stages"),
          {subtree: true, childList: true, characterData: true}); }""",
        before,
    )
    page.mouse.up()
    for _ in range(200):
        found = page.evaluate("() => window.taken")
        if found is not None:
            return float(found)
        page.wait_for_timeout(20)
    raise RuntimeError("the action was not taken: " + page.locator(".bar").last.inner_text())


def heap(session: CDPSession) -> float:
    """Return the heap (MB) that is left after a garbage collection."""
    session.send("HeapProfiler.collectGarbage")
    metrics = session.send("Performance.getMetrics")["metrics"]
    return float(next(it["value"] for it in metrics if it["name"] == HEAP)) / 1e6


@contextlib.contextmanager
def never_reading(page: Page) -> Iterator[None]:
    """Open the live messages with the cookie of a page, and read none."""
    cookies = page.context.cookies()
    cookie = "; ".join(f"{it['name']}={it['value']}" for it in cookies)
    host = page.url.split("/")[2]
    with connect(
        f"ws://{host}/api/live",
        origin=f"http://{host}",
        additional_headers={"Cookie": cookie},
        max_queue=1,
        ping_interval=None,
    ):
        yield


def study(browser: Browser, address: str, viewers: int, minutes: float) -> dict[str, Any]:
    """Measure one flight."""
    asked: list[str] = []
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    context.on("request", lambda it: asked.append(it.url))
    pilot = Watched(context.new_page())
    pilot.open(address)
    others = [browser.new_context().new_page() for _ in range(viewers - 1)]
    for page in others:
        page.goto(address)
    session = context.new_cdp_session(pilot.page)
    session.send("Performance.enable")
    paint = pilot.page.evaluate(
        "() => performance.getEntriesByName('first-contentful-paint')[0]?.startTime ?? NaN"
    )
    with never_reading(pilot.page):
        pilot.page.wait_for_timeout(20_000)
        first, delays = heap(session), pilot.delays()
        pilot.page.wait_for_timeout(60_000 * minutes)
        grown = heap(session) - first
        delays += pilot.delays()
        acts = [acted(pilot.page, it) for it in [".do-hold", ".do-continue"] * 5]
    host = address.split("/")[2]
    return {
        "viewers": viewers,
        "minutes": minutes,
        "paint": paint,
        "ticks": len(delays),
        "tick": np.percentile(delays, [50, 95]),
        "act": np.percentile(acts, [50, 95]),
        "acts": len(acts),
        "grown": grown,
        "foreign": sum(it.split("/")[2] != host for it in asked if it.startswith("http")),
    }


def main(arguments: Sequence[str]) -> None:
    """Run the study and print its page."""
    parser = argparse.ArgumentParser(prog="studies.page")
    parser.add_argument("--minutes", type=float, default=1.0)
    parser.add_argument("--viewers", type=int, default=5)
    wanted = parser.parse_args(arguments)
    chromium = shutil.which("chromium")
    if chromium is None:
        sys.exit("studies.page: no chromium here: apt-get install chromium")
    with (
        TemporaryDirectory() as name,
        flying(Path(name)) as address,
        sync_playwright() as playwright,
    ):
        browser = playwright.chromium.launch(executable_path=chromium, args=list(ARGUMENTS))
        found = study(browser, address, wanted.viewers, wanted.minutes)
        browser.close()
    command = f"python -m studies.page --minutes {wanted.minutes:g} --viewers {wanted.viewers}"
    print(PAGE.format(command=command, **found))  # noqa: T201


if __name__ == "__main__":
    main(sys.argv[1:])
