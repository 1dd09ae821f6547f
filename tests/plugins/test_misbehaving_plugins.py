"""Plug-ins that raise, answer nonsense or sleep: reported, held, led home and down."""

from __future__ import annotations

import math
from functools import partial
from pathlib import Path

import pytest
from rehearsed import Flight, flown, short_stage

from missionkit.api.missions import assemble
from missionkit.engine import flight_loop
from missionkit.engine.flight_end import FlightEnd
from missionkit.engine.timed_containment import WAITING, TimedContainment

PLUGINS = '''\
"""Everything that a plug-in should not do."""

import math
import time
from typing import Any, ClassVar

import numpy as np

from missionkit.messages import Estimate, Guidance, Step, Verdict
from missionkit.plugin import Behavior, Guard, WindowGuard


def trouble(how: str) -> object:
    if how == "raise":
        raise ValueError("no idea")
    if how == "stop":
        raise KeyboardInterrupt
    if how == "sleep":
        time.sleep(10.0)
    return None


class Gust(Guard):
    """Misbehaves above a metre."""

    kind: ClassVar[str] = "gust"
    how: str

    def check(self, seen: Estimate) -> Verdict:
        if seen.position[2] > -1.0:
            return Verdict(False)
        return Verdict.below(math.nan, 1.0) if self.how == "nan" else trouble(self.how)


class Memory(WindowGuard):
    """Cannot remember above a metre."""

    kind: ClassVar[str] = "memory"
    how: str

    def begin(self) -> int:
        return 0

    def advance(self, memory: Any, seen: Estimate) -> int:
        return memory if seen.position[2] > -1.0 else trouble(self.how)

    def check(self, memory: Any, seen: Estimate) -> Verdict:
        return Verdict(False)


class Drift(Behavior):
    """Flies nowhere."""

    kind: ClassVar[str] = "drift"
    how: str

    def step(self, seen: Estimate, memory: Any) -> Step:
        if self.how == "nan":
            return Step(Guidance(np.array([math.nan, 0.0, -3.0]), 5.0))
        return trouble(self.how)
'''

MISSION = """\
initial: idle
states:
  idle:
    kind: idle
    behavior: {{use: take_off, height: 3}}
    transitions: [{{to: up, when: done}}]
  up: {{kind: custom, behavior: {behavior}, transitions: [{{to: land, when: {guard}}}]}}
  return:
    kind: return
    behavior: {{use: go_to, target: home, height: 3}}
    transitions: [{{to: land, when: done}}]
  land: {{kind: land}}
"""


@pytest.fixture(scope="module")
def plugins(tmp_path_factory) -> Path:
    path = tmp_path_factory.mktemp("plugins") / "odd_ones.py"
    path.write_text(PLUGINS)
    return path


@pytest.fixture(autouse=True)
def impatient(monkeypatch):
    """Wait 10 ms instead of 250 ms for a plug-in, and 50 ms instead of 10 s for one that sleeps."""
    hasty = partial(TimedContainment, limit=0.01, patience=0.05)
    monkeypatch.setattr(flight_loop, "TimedContainment", hasty)


def flight_with(plugins: Path, behavior: str = "hold", guard: str = "done") -> Flight:
    text = MISSION.format(behavior=behavior, guard=guard)
    return flown(short_stage(text, catalogue=assemble([plugins])))


def check(flight: Flight, problem: str, states: list[str], ticks: int = 60) -> None:
    """Reported once, held for `ticks`, then home and down."""
    assert [to for to, _ in flight.went()] == states
    assert flight.went()[1] == ("return", "failsafe plug-in failed")
    assert problem in flight.problems()
    held = [record for record in flight.records if record.state == "up"]
    assert len(held) == pytest.approx(ticks, abs=3)
    assert {record.step_note for record in held[2:]} == {"holding: a plug-in misbehaves"}
    places = [record.estimate.position[:2] for record in held[2:]]
    assert max(math.dist(place, places[0]) for place in places) < 0.3
    assert flight.result.flown.end is FlightEnd.LANDED
    assert flight.result.grade.landed
    assert not flight.result.grade.crashed


HOME = ["up", "return", "land"]


@pytest.mark.parametrize(
    ("how", "problem"),
    [
        ("raise", "gust (how raise) raised ValueError: no idea"),
        ("stop", "gust (how stop) raised KeyboardInterrupt"),
        ("nan", "gust (how nan) returned a number that is not finite"),
        ("nothing", "gust (how nothing) returned NoneType, expected a Verdict"),
        ("sleep", f"gust (how sleep) raised TooSlowError: {WAITING}"),
    ],
)
def test_a_misbehaving_guard_is_reported_and_survived(plugins, how, problem):
    flight = flight_with(plugins, guard=f"{{use: gust, how: {how}}}")
    check(flight, problem, HOME)
    assert flight.went()[2] == ("land", "when done")


@pytest.mark.parametrize(
    ("how", "problem"),
    [
        ("raise", "drift raised ValueError: no idea"),
        ("stop", "drift raised KeyboardInterrupt"),
        ("nan", "drift returned a Step with guidance of a wrong type or not finite"),
        ("nothing", "drift returned NoneType, expected a Step"),
    ],
)
def test_a_misbehaving_behaviour_is_reported_and_survived(plugins, how, problem):
    flight = flight_with(plugins, behavior=f"{{use: drift, how: {how}}}")
    check(flight, problem, HOME)
    assert flight.went()[2] == ("land", "when done")


def test_a_memory_that_fails_in_every_state_leads_down_after_six_seconds(plugins):
    flight = flight_with(plugins, guard="{use: memory, how: raise}")
    problem = "memory (how raise) raised ValueError: no idea"
    check(flight, problem, HOME, ticks=40)  # the three seconds began while taking off
    assert flight.went()[2] == ("land", "failsafe plug-in failed")
    assert flight.entered("land") - flight.entered("up") == pytest.approx(5.0, abs=0.1)


def test_a_failure_is_reported_once(plugins):
    flight = flight_with(plugins, guard="{use: gust, how: raise}")
    assert flight.problems() == ["gust (how raise) raised ValueError: no idea"]
