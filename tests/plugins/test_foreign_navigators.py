"""Navigators and planners of other packages: checked before flight, contained in flight."""

import gc
import math
import threading
from functools import partial

import numpy as np
import pytest
from rehearsed import flown, short_stage

from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine import flight_loop
from missionkit.engine.flight_end import FlightEnd
from missionkit.engine.timed_containment import TimedContainment
from missionkit.errors import UsageError
from missionkit.estimation.builder import build
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.geometry import norm
from missionkit.plugin import Plugin

OUT = """\
navigation: {use: %s, how: %s}
avoid: %s
targets: {tree: {position: [30, 0, -3]}}
initial: idle
states:
  idle: {kind: idle, behavior: {use: take_off, height: 3}, transitions: [{to: out, when: done}]}
  out:
    kind: gps
    behavior: {use: go_to, target: tree, speed: 2}
    transitions: [{to: land, after: 20}]
  land: {kind: land}
"""
FAILS = 9.0  # s, in the air and on the way


class Shaky:
    """A navigator that misbehaves from some time on."""

    def __init__(self, inner, how):
        self.inner, self.how = inner, how

    def begin(self):
        if self.how == "begin":
            raise ValueError("not today")
        return self.inner.begin()

    def propagate(self, known, observation):
        if observation.now >= FAILS and self.how == "raise":
            raise ValueError("no idea")
        if observation.now >= FAILS and self.how == "sleep":
            threading.Event().wait(10.0)
        return self.inner.propagate(known, observation)

    def fuse(self, known, sightings):
        return self.inner.fuse(known, sightings)

    def pose_at(self, known, at):
        if self.how == "pose" and at >= FAILS:
            raise KeyError(at)
        return "nowhere" if self.how == "place" and at >= FAILS else self.inner.pose_at(known, at)

    def read(self, known):
        state = self.inner.read(known)
        if known.now >= FAILS and self.how == "nan":
            return state._replace(position=np.full(3, math.nan))
        return None if known.now >= FAILS and self.how == "nothing" else state


class Shaken(Plugin):
    """Parameters of it."""

    kind = "shaken"
    how: str

    def build(self, surveyed, mount):
        if self.how == "build":
            raise OSError("no such table")
        if self.how == "stop":
            raise KeyboardInterrupt
        if self.how == "none":
            return None
        return Shaky(build(VisualInertialEkf(), surveyed, mount), self.how)


class Veering(Plugin):
    """A planner that misbehaves on the way."""

    kind = "veering"
    how: str

    def begin(self):
        if self.how == "begin":
            raise ValueError("not today")
        if self.how == "stop":
            raise SystemExit

    def step(self, memory, seen, goal, wanted):
        if seen.now < FAILS or self.how == "well":
            return np.zeros(3), memory
        if self.how == "raise":
            raise ValueError("no idea")
        return {"nan": (np.full(3, math.nan), memory), "nothing": None}[self.how]


@pytest.fixture(autouse=True)
def impatient(monkeypatch):
    """Allow little time; a collection of garbage left by other tests would count as a plug-in's."""
    hasty = partial(TimedContainment, limit=0.02, patience=0.1)
    monkeypatch.setattr(flight_loop, "TimedContainment", hasty)
    gc.disable()
    yield
    gc.enable()


def ready(navigator="well", planner="none"):
    catalogue = builtin().extended("navigators", [Shaken]).extended("planners", [Veering])
    avoid = planner if planner == "none" else f"{{use: veering, how: {planner}}}"
    return short_stage(OUT % ("shaken", navigator, avoid), catalogue=catalogue)


def landed(flight):
    assert flight.result.flown.end is FlightEnd.LANDED
    assert (flight.result.grade.landed, flight.result.grade.crashed) == (True, False)


def test_a_navigator_of_another_package_that_does_well_is_flown():
    flight = flown(ready())
    landed(flight)
    assert (flight.problems(), flight.result.succeeded) == ([], True)


@pytest.mark.parametrize(
    ("how", "problem"),
    [
        ("raise", "shaken raised ValueError: no idea"),
        ("nan", "shaken returned a NavState with position of a wrong type or not finite"),
        ("nothing", "shaken returned NoneType, expected a NavState"),
        ("sleep", "shaken raised TooSlowError"),
    ],
)
def test_a_misbehaving_navigator_is_reported_and_the_vehicle_lands(how, problem):
    flight = flown(ready(how))
    landed(flight)
    assert [it for it in flight.problems() if it.startswith(problem)]
    assert flight.entered("land") < FAILS + 5.0
    after = [record for record in flight.records if record.now >= FAILS]
    assert all(record.estimate.health.diverged for record in after)
    assert all(np.isfinite(record.estimate.position).all() for record in after)


@pytest.mark.parametrize(
    ("how", "says"),
    [
        ("build", "navigator 'shaken' cannot be used: build raised OSError: no such table"),
        ("stop", "navigator 'shaken' cannot be used: build raised KeyboardInterrupt"),
        ("begin", "navigator 'shaken' cannot be used: begin raised ValueError: not today"),
        ("none", "what it builds lacks begin, propagate, fuse, pose_at, read"),
    ],
)
def test_a_navigator_that_does_not_begin_is_refused_before_flight(how, says):
    with pytest.raises(UsageError, match=says):
        ready(how)


@pytest.mark.parametrize(
    ("how", "problem"),
    [
        ("raise", "veering raised ValueError: no idea"),
        ("nan", "veering returned a velocity of a wrong type or not finite"),
        ("nothing", "veering returned NoneType, expected a velocity and its memory"),
    ],
)
def test_a_misbehaving_planner_is_reported_and_the_vehicle_stops_and_lands(how, problem):
    flight = flown(ready(planner=how))
    landed(flight)
    assert problem in flight.problems()
    held = [it for it in flight.records if it.state == "out" and it.now >= FAILS + 1.5]
    assert max((norm(it.command.setpoint.velocity) for it in held), default=0.0) < 0.3
    assert flight.went()[-1] == ("land", "failsafe plug-in failed")


def test_a_planner_without_a_memory_is_called():
    flight = flown(ready(planner="well"))
    assert (flight.problems(), flight.result.succeeded) == ([], True)


@pytest.mark.parametrize("how", ["begin", "stop"])
def test_a_planner_that_does_not_begin_is_refused_before_flight(how):
    with pytest.raises(UsageError, match="planner 'veering' cannot be used: begin raised"):
        ready(planner=how)
