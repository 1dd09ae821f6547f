"""A flight and its page: actions arrive, what must not does not, and the flight notices nothing."""

import json
import os
import signal
import threading
import uuid

import pytest
from browsing import Browser, port_of
from samples import HOP
from websockets.exceptions import InvalidStatus

import missionkit
from missionkit.engine.clock import date
from missionkit.engine.flight_loop import Operator
from missionkit.engine.prepared_mission import prepare
from missionkit.page.facts.mission_facts import FlownMission
from missionkit.page.live import flight_page as pages
from missionkit.page.live.flight_page import flight_page
from missionkit.page.server.binding import Binding
from missionkit.page.server.sessions import Tokens
from missionkit.recorder.record_reader import read
from missionkit.recorder.record_sinks import Reports
from missionkit.recorder.scenery import Scenery

WAIT = """\
missionkit: 1
mission: wait
camera: {use: none}
dwell: 0.1
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: 2}
    transitions: [{to: wait, when: done}]
  wait:
    kind: gps
    behavior: {use: hold}
    transitions: [{to: home, event: go}, {to: home, after: 600}]
  home:
    kind: return
    behavior: {use: go_to, target: home, height: 2}
    transitions: [{to: land, event: down}, {to: land, after: 300}]
  land: {kind: land}
"""


def loaded(tmp_path, text):
    path = tmp_path / "mission.yaml"
    path.write_text(text)
    return missionkit.load(path)


class Flying:
    """A flight with a page, in a thread."""

    def __init__(self, mission, folder, page, speed=None):
        self.operator, self.reports = Operator(), Reports()
        self.summary = None
        self.page = page

        def fly():
            with page.observing(self.operator, self.reports) as publisher:
                self.summary = missionkit.rehearse(
                    mission,
                    folder=folder,
                    observers=[publisher],
                    operator=self.operator,
                    speed=speed,
                )
            page.finish(self.summary.outcome, self.summary.reason)

        self.thread = threading.Thread(target=fly)
        self.thread.start()

    def ended(self):
        self.thread.join(120.0)
        assert not self.thread.is_alive()
        return self.summary


def shown(mission):
    plan = prepare(mission.model, mission.catalogue)
    return FlownMission(mission.model, mission.catalogue, plan, Scenery())


@pytest.fixture
def page(tmp_path):
    mission = loaded(tmp_path, WAIT)
    with flight_page(shown(mission), Binding(port=0), Tokens.fresh(), tmp_path / "run") as it:
        yield it


def entered(page, token):
    browser = Browser(port_of(page.address))
    assert browser.enter(token) == 200
    return browser


def act(browser, live, action, event=None, **changes):
    live.catch_up()
    body = {
        "id": str(uuid.uuid4()),
        "action": action,
        "event": event,
        "seen": live.now["seq"],
        "at_ms": date() * 1000.0,
        "held_ms": 1600,
    }
    return browser.post("/api/action", {**body, **changes})


def test_a_pilot_flies_by_the_page_and_nobody_else_does(page, tmp_path):
    flying = Flying(loaded(tmp_path, WAIT), tmp_path / "run", page, speed=4.0)
    tokens = page.address.tokens
    pilot, viewer = entered(page, tokens.pilot), entered(page, tokens.view)
    with pilot.live() as live:
        live.until(lambda it: {"action": "event", "event": "go"} in it["offered"])
        assert live.now["pilot"]["you"]
        refused = [
            act(viewer, live, "hold"),
            act(pilot, live, "hold", at_ms=date() * 1000.0 - 1500.0),
            act(pilot, live, "hold", held_ms=300),
            act(pilot, live, "land", held_ms=1200),
            act(pilot, live, "return", seen=-1),
            act(pilot, live, "event", "stop"),
            act(pilot, live, "arm"),
            pilot.post("/api/action", {"action": "land"}, Origin="http://evil.example"),
            pilot.post("/api/action", {"action": "land"}, X_CSRF=viewer.csrf),
            act(Browser(pilot.port), live, "land"),
        ]
        assert [status for status, _ in refused] == [403, *[409] * 6, 403, 403, 401]
        assert all(said["error"] for _, said in refused)
        with pytest.raises(InvalidStatus), pilot.live(Origin="http://evil.example"):
            pass
        _, hold = act(pilot, live, "hold")
        live.until(lambda it: it["paused"] and it["actions"][-1]["stage"] == "observed")
        assert live.now["actions"][-1]["id"] == hold["id"]
        assert act(pilot, live, "continue", id=hold["id"])[0] == 409  # replayed
        assert act(pilot, live, "continue")[0] == 202
        live.until(lambda it: not it["paused"])

        second = entered(page, tokens.pilot)
        with second.live() as other:
            other.until(lambda it: it["pilot"]["name"] == "pilot 1")
            assert not other.now["pilot"]["you"]
            assert act(second, other, "event", "go")[0] == 403
            assert second.post("/api/pilot", {"do": "ask"})[0] == 200
            live.until(lambda it: it["pilot"]["asked_by"])
            assert pilot.post("/api/pilot", {"do": "grant"})[0] == 200
            other.until(lambda it: it["pilot"]["you"])
            assert act(pilot, live, "event", "go")[0] == 403
            assert act(second, other, "event", "go")[0] == 202
            other.until(lambda it: it["state"] == "home")
            assert act(second, other, "event", "down")[0] == 202
            ended = other.until(lambda it: it["ended"])["ended"]
    summary = flying.ended()
    assert [it.to for it in summary.transitions] == ["wait", "home", "land"]
    assert ended["outcome"] == summary.outcome
    said = [it.data["message"] for it in read(tmp_path / "run" / "flight.mcap", "/log")]
    done = [it.removeprefix("pilot ") for it in said if it.startswith("pilot ")]
    assert done == [
        "1 at 127.0.0.1: took the controls",
        "1 at 127.0.0.1: hold",
        "1 at 127.0.0.1: continue",
        "2 at 127.0.0.1: asked for the controls",
        "2 at 127.0.0.1: took the controls, granted by pilot 1",
        "2 at 127.0.0.1: event go",
        "2 at 127.0.0.1: event down",
    ]
    assert missionkit.replay(tmp_path / "run")[0].difference is None


def test_the_record_is_the_same_whatever_becomes_of_the_page(tmp_path, monkeypatch):
    mission = loaded(tmp_path, HOP)
    plain = missionkit.rehearse(mission, folder=tmp_path / "plain").record_hash
    started = []
    start = pages._started

    def remembered(files):
        started.append(start(files))
        return started[-1]

    monkeypatch.setattr(pages, "_started", remembered)
    for sort in ("stopped", "killed"):
        with flight_page(shown(mission), Binding(port=0), Tokens.fresh(), tmp_path / sort) as page:
            browser = entered(page, page.address.tokens.view)
            with browser.live():  # and never read but for the handshake
                if sort == "stopped":  # the link fills up
                    os.kill(started[-1].pid, signal.SIGSTOP)
                else:
                    started[-1].kill()
                    started[-1].wait()
                flying = Flying(mission, tmp_path / sort, page)
                assert flying.ended().record_hash == plain, sort
                if sort == "stopped":
                    os.kill(started[-1].pid, signal.SIGCONT)
        said = [it for it in flying.reports.all if "server has ended" in it]
        assert len(said) == (sort == "killed")


def test_the_server_ends_with_the_flight_and_says_how_it_went(page, tmp_path):
    browser = entered(page, page.address.tokens.view)
    with browser.live() as live:
        flying = Flying(loaded(tmp_path, WAIT), None, page, speed=50.0)
        live.until(lambda it: it.get("in_air"))
        flying.operator.land()
        ended = live.until(lambda it: it.get("ended"))["ended"]
        assert ended["outcome"] == flying.ended().outcome
        timeline = browser.get("/api/timeline")
        assert timeline["fired"][-1]["reason"] == "operator: land"
        assert timeline["lanes"][0]["state"] == "idle"
        assert json.loads(browser.request("GET", "/api/track")[2])["points"]
