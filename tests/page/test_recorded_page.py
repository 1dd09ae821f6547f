"""The page of a recording shows what was recorded, at any time and in any order."""

import json
import re

import pytest
from defusedxml.ElementTree import fromstring

from missionkit.recorder.record_reader import read


def at(time):
    return lambda shown: abs(shown.get("now", -1.0) - time) < 1e-6


def test_every_value_is_that_of_the_record_at_the_same_tick(browser, run):
    poses = {round(it.at, 6): it.data for it in read(run / "flight.mcap", "/pose")}
    states = {round(it.at, 6): it.data for it in read(run / "flight.mcap", "/state")}
    guards = {round(it.at, 6): it.data for it in read(run / "flight.mcap", "/guards")}
    times = sorted(set(poses) & set(states) & set(guards))[::7]
    compared = 0
    with browser.live() as live:
        for time in [*times[1::2], *reversed(times[::2])]:  # forwards, then backwards
            live.send(t="seek", at=time)
            shown = live.until(at(time))
            place = poses[time]["pose"]["position"]
            assert shown["position"] == [place["x"], place["y"], place["z"]]
            assert shown["state"] == states[time]["state"]
            assert shown["mode"] == states[time]["mode"]
            answers = {it["name"]: it for it in shown["guards"]}
            for said in guards[time]["guards"]:
                shown_one = answers[said["name"]]
                holds = {"yes": True, "no": False, "unknown": None}[said["holds"]]
                assert shown_one["holds"] is holds
                for key in ("value", "threshold", "margin"):
                    assert shown_one[key] == said.get(key)
                    compared += 1
            compared += 5
    assert compared > 100


def test_it_plays_steps_and_stops_at_the_end(browser, recorded):
    with browser.live() as live:
        live.send(t="seek", at=2.0)
        number = live.until(at(2.0))["tick"]
        live.send(t="step", by=1)
        assert live.until(lambda it: it["tick"] != number)["tick"] == number + 1
        live.send(t="step", by=-1)
        live.until(lambda it: it["tick"] == number)
        live.send(t="play", speed=50.0)
        ended = live.until(lambda it: it["playback"]["at"] == recorded.end)
    assert ended["state"] == "land"
    assert not ended["playback"]["playing"]
    assert live.kinds[0] == "snapshot"
    assert set(live.kinds[1:]) == {"delta"}


def test_the_timeline_has_states_and_transitions_with_their_ids(browser):
    mission, timeline = browser.get("/api/mission"), browser.get("/api/timeline")
    ids = {it["id"]: it for it in mission["transitions"]}
    assert [it["state"] for it in timeline["lanes"]] == ["idle", "land"]
    (fired,) = timeline["fired"]
    assert ids[fired["id"]]["source"] == fired["source"] == "idle"
    assert ids[fired["id"]]["text"] == fired["reason"]
    track = browser.get("/api/track")
    assert len(track["at"]) == len(track["points"]) > 100
    assert min(down for _, _, down in track["points"]) < -1.0


def test_the_chart_names_its_states_and_transitions_and_has_no_style(browser):
    _, headers, data = browser.request("GET", "/api/chart.svg")
    assert headers["content-type"] == "image/svg+xml"
    root = fromstring(data)
    assert not re.search(rb"<style|\sstyle=|<script", data)
    states = {it.get("data-state") for it in root.iter()} - {None}
    transitions = {it.get("data-transition") for it in root.iter()} - {None}
    mission = browser.get("/api/mission")
    assert states == {it["name"] for it in mission["states"]}
    assert transitions <= {it["id"] for it in mission["transitions"]}
    assert transitions


def test_a_guard_has_its_curve(browser):
    series = browser.get("/api/series?guard=done&since=0")
    assert len(series["at"]) == len(series["holds"]) > 10
    assert browser.get("/api/series?guard=nobody&since=0")["at"] == []
    status, _, data = browser.request("GET", "/api/series?guard=done&since=nan")
    assert (status, json.loads(data)) == (400, {"error": "since must be a number"})


def test_a_transition_says_why_and_other_values_what_they_would_have_changed(browser):
    (fired,) = browser.get("/api/timeline")["fired"]
    answer = browser.get(f"/api/why?transition={fired['id']}&at={fired['at']}")
    assert (answer["fired"], answer["at"]) == (True, pytest.approx(fired["at"]))
    assert [it["guard"] for it in answer["conjuncts"]] == ["done"]
    before = browser.get(f"/api/why?transition={fired['id']}&at=2.0")
    assert not before["fired"]
    assert "not taken up to 2.00 s" in before["text"]
    assert browser.request("GET", "/api/why?transition=t99")[0] == 404
    status, said = browser.post("/api/what-if", {"set": {"height": 3.0}, "from": None})
    assert status == 200
    assert said["rows"][0]["kind"] in {"later", "missing"}
    assert said["evidence_until"] is not None
    status, said = browser.post("/api/what-if", {"set": {"width": 3.0}})
    assert (status, "width" in said["error"]) == (409, True)


@pytest.mark.parametrize("what", ["action", "pilot", "play"])
def test_a_recording_takes_no_orders(browser, what):
    status, said = browser.post(f"/api/{what}", {"action": "land"})
    assert (status, said["error"]) == (409, f"this is a recording: it knows no {what}")
