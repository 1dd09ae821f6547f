"""What a pilot and a viewer see and do in a browser; where time matters, it is the test's."""

from __future__ import annotations

import random
from collections.abc import Iterator
from contextlib import ExitStack

import pytest
from browsing import served
from chromium import AXE, NARROW, WIDE, Tab, launched, needs_chromium, opened
from played_chart import play_source
from playwright.sync_api import Browser
from scripted_flight import OFFERED, STATES, ScriptedFlight, chart, guard, mission

from missionkit.page.recording.recorded_run import RecordedRun
from missionkit.page.recording.recording_source import RecordingSource
from missionkit.page.server.page_source import PageError
from missionkit.page.server.sessions import Tokens

pytestmark = needs_chromium
TOKENS = Tokens("pilot-token", "view-token")


@pytest.fixture(scope="module")
def chromium() -> Iterator[Browser]:
    with launched() as browser:
        yield browser


@pytest.fixture
def flight() -> ScriptedFlight:
    return ScriptedFlight()


def reload_shown(tab: Tab, flight: ScriptedFlight) -> None:
    """Wait until the page has the mission, not only the ticks."""
    tab.shows("h1 .title", flight.about["title"])
    tab.has("[data-state] .name")


def boxes(tab: Tab, selector: str) -> list[list[float]]:
    return tab.page.evaluate(
        """selector => [...document.querySelectorAll(selector)]
        .map(it => it.getBoundingClientRect()).filter(it => it.width && it.height)
        .map(it => [it.left, it.top, it.right, it.bottom])""",
        selector,
    )


def serious(tab: Tab) -> list[tuple[str, str]]:
    """Return what axe finds that keeps people out."""
    if not tab.page.evaluate("() => 'axe' in window"):
        tab.page.add_script_tag(path=AXE)
    found = tab.page.evaluate("() => axe.run({resultTypes: ['violations']})")["violations"]
    bad = [it for it in found if it["impact"] in {"serious", "critical"}]
    return [(it["id"], it["nodes"][0]["html"]) for it in bad]


def overlaps(rows: list[list[float]]) -> list[tuple[int, int]]:
    return [
        (one, other)
        for one, a in enumerate(rows)
        for other, b in enumerate(rows[:one])
        if min(a[2], b[2]) - max(a[0], b[0]) > 1 and min(a[3], b[3]) - max(a[1], b[1]) > 1
    ]


# Records what the page shows after every change: the tick, and what stands beside it.
WATCH = """() => {
  window.seen = [];
  const all = selector => [...document.querySelectorAll(selector)];
  const numbers = row => ["value", "threshold", "margin"]
    .map(it => row.querySelector(`[data-${it}]`)?.dataset[it] ?? "");
  const note = () => window.seen.push({
    tick: Number(document.querySelector(".guards").dataset.tick),
    state: document.querySelector("#state").textContent,
    lit: all("[data-state].active").map(it => it.dataset.state),
    flash: all("[data-transition].fired").map(it => it.dataset.transition),
    guards: Object.fromEntries(
      all(".guard").map(row => [row.dataset.guard, [row.dataset.holds, ...numbers(row)]])),
  });
  new MutationObserver(() => setTimeout(note)).observe(document.querySelector("#page"),
    {subtree: true, childList: true, attributes: true, characterData: true});
}"""


def test_every_transition_and_every_value_of_a_flight_is_shown(chromium, flight):
    rng = random.Random(17)  # noqa: S311
    ticks = {}
    with served(flight, TOKENS) as address, opened(chromium, address.pilot) as tab:
        reload_shown(tab, flight)
        assert "token" not in tab.page.url
        tab.page.evaluate(WATCH)
        states = []
        for at in range(20):
            state = STATES[(at + 1) % len(STATES)]
            fired = {"id": f"t{at % 3 + 1}", "source": flight.values["state"], "to": state}
            guards = [guard(f"g{n}", rng.uniform(-2, 2), rng.uniform(-1, 1)) for n in range(17)]
            tick = flight.values["tick"] + 1
            now = 0.05 * tick
            flight.show(
                state=state,
                active=[state],
                guards=guards,
                entered_at=now,
                fired=[{"at": now, "tick": tick, "reason": f"reason {at}", **fired}],
            )
            ticks[tick] = guards
            states.append((state, fired["id"]))
            tab.shows("#state", state)
            tab.has(f".guards[data-tick='{tick}']")
        seen = tab.page.evaluate("() => window.seen")
        assert tab("section.timeline-panel .events .fired").count() == 20
        assert not tab.errors
        host = address.url.removeprefix("http://").rstrip("/")
        assert {it.split("/")[2] for it in tab.asked if not it.startswith("data:")} == {host}
    for tick, (state, way) in zip(ticks, states, strict=True):
        shown = [it for it in seen if it["tick"] == tick]
        assert {it["state"] for it in shown} == {state}
        assert shown[-1]["lit"] == [state]
        assert any(way in it["flash"] for it in shown)
    compared = 0
    for tick, guards in ticks.items():
        (rows,) = {repr(it["guards"]): it["guards"] for it in seen if it["tick"] == tick}.values()
        for it in guards:
            holds, *numbers = rows[it["name"]]
            assert holds == ("yes" if it["holds"] else "no")
            assert [*map(float, numbers)] == [it["value"], it["threshold"], it["margin"]]
            compared += 3
    assert compared > 1000


@pytest.mark.parametrize("key", ["pointer", "Space"])
def test_only_a_hold_that_is_released_inside_acts(chromium, flight, key):
    with served(flight, TOKENS) as address, opened(chromium, address.pilot, clock=True) as tab:
        paused(tab, flight)
        press = Press(tab, flight, ".do-hold", key)
        if key == "pointer":
            tab(".do-hold").click()
            tab(".do-hold").dblclick()
        press.held(300)
        assert "Nothing was sent" in tab.text(".hint")
        press.held(5200)
        assert "more than 5 s" in tab.text(".hint")
        press.cancelled(700)
        press.withdrawn(700)
        assert not flight.sent()
        press.held(600)
        tab.until(lambda: bool(flight.sent()))
        tab.has("[data-stage='sent']")
        (body,) = flight.sent()
        assert body["action"] == "hold"
        assert 600 <= body["held_ms"] < 700
        landing = Press(tab, flight, ".do-land", "Enter" if key == "Space" else key)
        landing.held(1000)
        landing.held(1600)
        tab.until(lambda: len(flight.sent()) == 2)
        assert [it["action"] for it in flight.sent()] == ["hold", "land"]
        assert not tab.errors


def paused(tab: Tab, flight: ScriptedFlight) -> None:
    """Load the page, then let its clock, which is also the vehicle's, stand still."""
    reload_shown(tab, flight)
    tab.pause()
    flight.stamp = tab.now
    fresh(tab, flight)


def fresh(tab: Tab, flight: ScriptedFlight, **values: object) -> None:
    """Show a tick that has just been computed."""
    flight.show(**values)
    tab.has(f".guards[data-tick='{flight.values['tick']}']")
    tab.page.clock.run_for(120)
    tab.has(".page[data-freshness='fresh']")


class Press:
    """Presses of one button, by pointer or key; the page's clock runs only while it is held."""

    def __init__(self, tab: Tab, flight: ScriptedFlight, selector: str, key: str) -> None:
        self.tab, self.flight, self.selector, self.key = tab, flight, selector, key

    def down(self) -> None:
        fresh(self.tab, self.flight)
        self.tab(self.selector).focus()
        if self.key == "pointer":
            self.tab(self.selector).hover()
            self.tab.page.mouse.down()
        else:
            self.tab.page.keyboard.down(self.key)

    def up(self) -> None:
        if self.key == "pointer":
            self.tab.page.mouse.up()
        else:
            self.tab.page.keyboard.up(self.key)
        self.tab.page.clock.run_for(20)

    def held(self, ms: int) -> None:
        self.down()
        self.tab.page.clock.run_for(ms)
        self.up()

    def cancelled(self, ms: int) -> None:
        self.down()
        self.tab.page.clock.run_for(ms)
        self.tab.has(f"{self.selector}.ready")
        if self.key == "pointer":
            self.tab.page.mouse.move(700, 300)
        else:
            self.tab.page.keyboard.press("Escape")
        self.up()
        assert "Cancelled" in self.tab.text(".hint")

    def withdrawn(self, ms: int) -> None:
        self.down()
        self.tab.page.clock.run_for(ms)
        fresh(self.tab, self.flight, offered=OFFERED[1:])
        self.up()
        assert "no longer offered" in self.tab.text(".hint")
        fresh(self.tab, self.flight, offered=OFFERED)


def test_stages_refusals_and_late_data(chromium, flight):
    with ExitStack() as stack:
        address = stack.enter_context(served(flight, TOKENS))
        tab = stack.enter_context(opened(chromium, address.pilot, clock=True))
        paused(tab, flight)
        go = Press(tab, flight, ".do-event", "Space")
        flight.refusal = PageError("the chart does not wait for 'go' now", 409)
        go.held(600)
        tab.has("[data-stage='refused']")
        assert "the chart does not wait for 'go' now" in tab.text(".stages")
        flight.refusal = None
        go.held(600)
        tab.until(lambda: len(flight.sent()) == 2)
        body = flight.sent()[1]
        assert body["event"] == "go"
        entry = {"id": body["id"], "action": "event", "event": "go", "who": "pilot 1", "says": ""}
        for stage in ("taken", "acknowledged", "observed"):
            fresh(tab, flight, actions=[{**entry, "stage": stage, "tick": 7}])
            tab.has(f"[data-stage='{stage}']")
        assert "taken at tick 7" in tab.text(".stages")
        tab.page.clock.run_for(600)
        tab.has(".page[data-freshness='late']")
        assert "old" in tab.text(".banner")
        assert tab(".hold[aria-disabled='false']").count() == 4
        tab.page.clock.run_for(1600)
        tab.has(".page[data-freshness='old']")
        assert tab(".hold[aria-disabled='false'] .word").all_inner_texts() == ["HOLD"]
        assert "may not arrive" in tab.text(".do-hold")
        fresh(tab, flight)
        assert tab(".banner").count() == 0


def test_one_pilots_and_others_look_on(chromium, flight):
    with ExitStack() as stack:
        address = stack.enter_context(served(flight, TOKENS))
        viewer = stack.enter_context(opened(chromium, address.view))
        flight.show(pilot={"you": False, "name": "pilot 1", "asked_by": None, "silent_for": 0.2})
        reload_shown(viewer, flight)
        viewer.shows(".viewer span", "pilot 1 pilots. You may look on.")
        assert viewer(".hold").count() == viewer(".viewer button").count() == 0
        pilot = stack.enter_context(opened(chromium, address.pilot))
        reload_shown(pilot, flight)
        pilot(".viewer button").click()
        pilot.until(lambda: flight.sent("pilot") == [{"do": "ask"}])
        flight.show(pilot={"you": True, "name": "pilot 2", "asked_by": "pilot 3", "silent_for": 0})
        pilot.shows(".takeover h2", "pilot 3 asks for control")
        pilot(".takeover").get_by_text("Hand over", exact=True).click()
        pilot.until(lambda: flight.sent("pilot")[1:] == [{"do": "grant"}])
        pilot.page.reload()
        reload_shown(pilot, flight)  # the cookie is enough
        stack.enter_context(opened(chromium, address.url, shows=".no-way-in"))


def test_a_lost_server_is_said_and_found_again(chromium, flight):
    with ExitStack() as server, ExitStack() as stack:
        address = server.enter_context(served(flight, TOKENS))
        tab = stack.enter_context(opened(chromium, address.pilot))
        reload_shown(tab, flight)
        server.close()
        tab.has(".banner.bad")
        assert "No connection" in tab.text(".banner")
        port = int(address.url.rstrip("/").rpartition(":")[2])
        again = ScriptedFlight(mission("resumed"))
        stack.enter_context(served(again, TOKENS, port))
        reload_shown(tab, again)

        def quiet() -> bool:
            again.show()  # a flight goes on
            return tab(".banner").count() == 0

        tab.until(quiet)


@pytest.mark.parametrize("size", [WIDE, NARROW], ids=["wide", "narrow"])
def test_it_is_accessible_and_fits(chromium, flight, size):
    with (
        served(flight, TOKENS) as address,
        opened(chromium, address.pilot, size, reduced_motion="reduce", bypass_csp=True) as tab,
    ):
        reload_shown(tab, flight) if size == WIDE else tab.has(".map")
        tabs = tab("[role=tab]").count() or 1
        for at in range(tabs):
            if tabs > 1:
                tab("[role=tab]").nth(at).click()
            for theme in ("light", "dark") if tabs == 1 else (("light", "dark")[at % 2],):
                tab.page.emulate_media(color_scheme=theme, reduced_motion="reduce")
                assert serious(tab) == []
            small = [
                it
                for it in boxes(tab, "button, select, input:not([type=checkbox]), .known")
                if it[2] - it[0] < 44 or it[3] - it[1] < 44
            ]
            assert small == []
            assert overlaps(boxes(tab, ".panel, .top, .bar, .tabs")) == []
            assert overlaps(boxes(tab, ".tools button, .hold, [role=tab]")) == []
            wide, room = tab.page.evaluate(
                "() => [document.documentElement.scrollWidth, innerWidth]"
            )
            assert wide <= room
        tab.page.keyboard.press("Tab")
        for _ in range(60):
            if tab.page.evaluate("() => document.activeElement.matches('.do-hold')"):
                break
            tab.page.keyboard.press("Tab")
        else:
            pytest.fail("the keyboard does not reach HOLD")
        flight.show(
            fired=[{"at": 1, "tick": 2, "id": "t1", "source": "a", "to": "b", "reason": ""}]
        )
        assert not tab.page.evaluate(
            "() => document.getAnimations().filter(it => it.playState === 'running').length"
        )


HOSTILE = "<script>window.hit=1</script><img src=x onerror='window.hit=1'>"


def test_names_are_text_however_long(chromium):
    long = "A" * 10_000
    states = (HOSTILE, long)
    flight = ScriptedFlight(mission(HOSTILE, states), chart(STATES))
    flight.show(
        state=long,
        active=[long],
        reason=HOSTILE,
        guards=[guard(long, 1.0, 2.0), guard(HOSTILE, 1.0, 2.0)],
        offered=[{"action": "event", "event": long}, {"action": "event", "event": HOSTILE}],
        pilot={"you": True, "name": long, "asked_by": HOSTILE, "silent_for": 0.0},
        targets=[{"name": long, "at": [1, 2, 3], "sd": 1.0, "seen_ago": None}],
        requirements=[{"name": long, "verdict": "open"}],
        problems=[{"at": 0.1, "says": long, "times": 1}],
    )
    for size in (WIDE, NARROW):
        with served(flight) as address, opened(chromium, address.url, size) as tab:
            tab.shows("#state", long)
            tab.shows("h1 .title", HOSTILE)
            tab.has(".takeover")
            wide, room = tab.page.evaluate(
                "() => [document.documentElement.scrollWidth, innerWidth]"
            )
            assert wide <= room
            assert all(it[2] <= room for it in boxes(tab, "button, .cut"))
            assert tab("script").count() == 1
            assert tab("img[src='x']").count() == 0
            assert tab.page.evaluate("() => window.hit") is None
            assert overlaps(boxes(tab, ".panel, .top, .bar, .tabs")) == []
            assert overlaps(boxes(tab, ".hold, .stages")) == []
            assert not tab.errors


def test_a_recording_is_sought_stepped_and_played(chromium, recorded: RecordedRun):
    with served(RecordingSource(recorded)) as address, opened(chromium, address.url) as tab:
        tab.has("[data-state].active")
        names = tab(".events b").all_inner_texts()
        tab("[aria-label='next transition']").click()
        first = recorded.timeline.as_value()["fired"][0]
        tab.shows("#state", first["to"])
        tab.has(f".state[data-tick='{first['tick']}']")
        tab("[aria-label='one tick on']").click()
        tab.has(f".state[data-tick='{first['tick'] + 1}']")
        tab("[aria-label='one tick back']").click()
        tab.has(f".state[data-tick='{first['tick']}']")
        assert len(tab(".events b").all_inner_texts()) == len(names) + 1
        tab(".speed select").select_option("20")
        tab("[aria-label='play']").click()
        tab.shows("#state", "land")
        assert not tab.errors


def test_a_chart_is_played_with(chromium, tmp_path):
    with (
        served(play_source(tmp_path)) as address,
        opened(chromium, address.url, reduced_motion="reduce", bypass_csp=True) as tab,
    ):
        tab.shows("#state", "idle")
        slider = "[data-quantity='done'] input[type=range]"
        second = tab.page.get_by_text("+1 s", exact=True)
        tab.page.get_by_text("+10 s", exact=True).click()  # the chart dwells in a state
        tab.shows(".clock b", "0:10.05")
        tab(slider).fill("1")
        tab.shows("#state", "out")
        tab.has("[data-state='out'].active")
        tab(slider).fill("0")
        tab("[data-quantity='battery'] .known input").uncheck()
        tab.shows("[data-quantity='battery'] output", "unknown")
        second.click()
        tab("[data-quantity='battery'] .known input").check()
        tab("[data-quantity='battery'] input[type=range]").fill("0.1")
        second.click()
        tab.shows("#state", "home")
        assert serious(tab) == []
        tab.page.get_by_text("Start again", exact=True).click()
        tab.shows("#state", "idle")
        tab.until(lambda: tab(".events li").count() == 0)
        assert not tab.errors
