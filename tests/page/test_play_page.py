"""A chart that is played with: values are set, time passes, the chart's own tick decides."""

import pytest
from browsing import Browser, port_of, served
from played_chart import play_source


@pytest.fixture
def played(tmp_path):
    with served(play_source(tmp_path)) as address:
        browser = Browser(port_of(address))
        browser.enter()
        with browser.live() as live:
            live.next()
            yield browser, live


def play(played, **what):
    browser, live = played
    before = live.now["now"]
    status, said = browser.post("/api/play", what)
    assert status == 200, said
    return live.until(lambda it: abs(it["now"] - said["now"]) < 0.051 and it["now"] != before)


def quantity(shown, name):
    return next(it for it in shown["play"]["quantities"] if it["name"] == name)


def test_values_lead_through_the_chart(played):
    shown = played[1].now
    assert (shown["state"], shown["play"]["faults"][:2]) == ("idle", ["link", "battery"])
    assert quantity(shown, "battery")["thresholds"] == [0.2]
    assert quantity(shown, "battery")["value"] == 1.0
    assert quantity(shown, "link silence")["max"] > 3.0
    assert play(played, advance=3.0)["state"] == "idle"  # no failsafe on the way up
    assert play(played, quantity={"done": 1})["state"] == "out"
    play(played, quantity={"distance to pole": 1.0})
    shown = play(played, advance=1.9)
    assert shown["state"] == "out"
    row = next(it for it in shown["guards"] if it["name"].startswith("within"))
    assert (row["holds"], row["value"], row["threshold"], row["margin"]) == (True, 1.0, 2.0, 1.0)
    assert row["needs"] == 1.5
    shown = play(played, advance=0.5)
    assert (shown["state"], shown["reason"]) == (
        "home",
        "when within (of pole, radius 2) for 1.5 s",
    )


def test_unknown_faults_events_and_a_new_beginning(played):
    play(played, advance=3.0)
    assert play(played, quantity={"done": 1})["state"] == "out"
    assert play(played, quantity={"distance to pole": None})["state"] == "out"
    assert not quantity(played[1].now, "distance to pole")["known"]
    assert play(played, event="back")["reason"] == "on back"
    shown = play(played, fault="link")
    assert (shown["state"], shown["reason"]) == ("land", "failsafe link")
    assert shown["play"]["active_faults"] == ["link"]
    assert play(played, fault="link")["play"]["active_faults"] == []
    shown = play(played, reset=True)
    assert (shown["state"], shown["play"]["clock"]) == ("idle", pytest.approx(0.05))


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ({"quantity": {"batery": 1}}, "quantity 'batery' is unknown; known: done"),
        ({"quantity": {"battery": "full"}}, "a number, or null"),
        ({"fault": "wings"}, "fault 'wings' is unknown; known: link"),
        ({"advance": -1}, "advance: seconds"),
        ({"fly": True}, "'fly' is unknown; known: reset"),
    ],
)
def test_what_cannot_be_played_gets_a_sentence(played, body, says):
    status, said = played[0].post("/api/play", body)
    assert status == 400
    assert says in said["error"]
