"""Patterns that are interrupted in the middle continue where they were, by the truth.

What is flown before and after must cover what an undisturbed flight flies, once.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from rehearsed import Flight, flown, killed, short_stage

from missionkit.engine.flight_loop import Operator
from missionkit.messages import CONTINUE, PAUSE, Observation, Record
from missionkit.recorder.value_codec import read, written
from missionkit.rehearsal.rehearse import Again, rehearse

CHART = """\
targets:
  a: {{position: [7, 0, -4]}}
  b: {{position: [7, 7, -4]}}
initial: up
states:
  up:
    kind: idle
    behavior: {{use: take_off, height: 4}}
    transitions: [{{to: work, when: done}}]
  work: {work}
  land: {{kind: land}}
"""
ONE = "{{kind: custom, behavior: {0}, transitions: [{{to: land, when: {1}}}]}}"
FOR_EACH = """
    for_each: {item: [a, b]}
    initial: go
    states:
      go:
        kind: custom
        behavior: {use: go_to, target: $item}
        transitions: [{to: seen, when: done}]
      seen: {final: true}
    transitions: [{to: land, when: done}]"""
AREA = "[[3, 0], [12, 0], [12, 6], [3, 6]]"
PATTERNS = {
    "waypoints": "{use: waypoints, places: [[6, 0], {at: [6, 6], wait: 3}, [0, 6]], speed: 2}",
    "survey": f"{{use: survey, polygon: {AREA}, height: 4, spacing: 3, turn_around: 2,"
    " speed: 2.5}",
    "corridor": "{use: corridor, line: [[2, 0], [10, 0]], breadth: 4, spacing: 2, height: 4,"
    " turn_around: 1, speed: 2}",
    "orbit": "{use: orbit, target: a, radius: 4, turns: 1}",
    "expanding_square": "{use: expanding_square, spacing: 3, outer: 3, speed: 2}",
    "sector": "{use: sector, radius: 3, speed: 2}",
    "spiral": "{use: spiral, target: a, outer: 3, speed: 1}",
    "follow": "{use: follow, target: a, distance: 9, side: bearing, bearing_deg: 0, speed: 1}",
    "climb": "{use: climb, height: 12}",
    "loiter": "{use: loiter, seconds: 8}",
    "point_at": "{use: point_at, target: b, within_deg: 1}",
    "for_each": "",
}
ENDLESS = {"spiral", "follow"}
GAP = 4.0  # s that the vehicle holds alone
WAY_BACK = 8.0  # s more that an interruption may cost


class Paused(Operator):
    """Pauses at a tick and continues at another."""

    def __init__(self, first: int, last: int) -> None:
        super().__init__()
        self.due, self.ticks = {first: PAUSE, last: CONTINUE}, 0

    def take(self) -> tuple[str, ...]:
        self.ticks += 1
        return (self.due[self.ticks],) if self.ticks in self.due else ()


def chart(name: str) -> str:
    end = "{use: elapsed, longer_than: 16}" if name in ENDLESS else "done"
    one = ONE.format(PATTERNS[name], end)
    return CHART.format(work=FOR_EACH if name == "for_each" else one)


@cache
def undisturbed(name: str) -> Flight:
    return flown(short_stage(chart(name)))


def span(flight: Flight) -> tuple[float, float]:
    return flight.entered("work"), flight.entered("land")


def between(rows: np.ndarray, first: float, last: float) -> np.ndarray:
    """Return where the vehicle was (N, 3), m, ten times a second."""
    return rows[(rows[:, 0] >= first) & (rows[:, 0] <= last)][::5, 1:4]


def apart(places: np.ndarray, line: np.ndarray) -> float:
    """Return how far (m) the farthest of some places is from a line of places."""
    gaps = np.linalg.norm(places[:, None, :] - line[None, :, :], axis=2)
    return float(gaps.min(axis=1).max())


def continued(name: str, at: float) -> tuple[float, list[Record], np.ndarray]:
    """Return when a flight left off, the ticks after it was resumed, and the truth."""
    kept, before = killed(short_stage(chart(name)), lambda it: it.course.memory.now >= at)
    kept = read(written(kept))
    ready, records = short_stage(chart(name)), []

    def watch(record: Record, _: Observation) -> None:
        records.append(record)

    assert rehearse(ready, [watch], again=Again(kept, before, GAP)).grade.landed
    return kept.course.memory.now, records, ready.vehicle.track.rows


@pytest.mark.parametrize("name", PATTERNS)
def test_a_pattern_whose_process_is_killed_continues_where_it_was(name):
    whole = undisturbed(name)
    first, last = span(whole)
    at, records, rows = continued(name, first + 0.45 * (last - first))
    over = next(r.now for r in records for fired in r.fired if fired.to == "land")
    if name in ENDLESS:  # `elapsed` counts while no process runs
        last -= records[0].now - at
    assert all(fired.to != "work" for r in records for fired in r.fired)
    check(whole, (at, records[0].now, over), rows, last)


@pytest.mark.parametrize("name", ["orbit", "spiral", "loiter", "for_each"])
def test_a_pattern_that_the_operator_pauses_continues_where_it_was(name):
    whole = undisturbed(name)
    first, last = span(whole)
    at = first + 0.45 * (last - first)
    pause = Paused(round(at / 0.05), round((at + 30.0) / 0.05))
    flight = flown(short_stage(chart(name)), pause)
    begun, over = span(flight)
    assert begun == first
    held = [r for r in flight.records if at + 5.0 <= r.now < at + 29.0]
    assert {r.step_note for r in held} == {
        "paused by the operator: 'operator.continue' lets it continue"
    }
    assert np.ptp([r.estimate.position for r in held], axis=0).max() < 0.5
    check(whole, (at, at + 30.0, over), flight.ready.vehicle.track.rows, last)


def check(whole: Flight, times: tuple[float, float, float], rows: np.ndarray, last: float) -> None:
    """Compare with the undisturbed flight.

    Args:
        whole: the undisturbed flight.
        times: s, when it was interrupted, continued and done.
        rows: the truth.
        last: s, when the undisturbed flight is done.
    """
    at, again, over = times
    first, _ = span(whole)
    line = between(whole.ready.vehicle.track.rows, first, last)
    done = np.vstack((between(rows, first, at), between(rows, again, over)))
    assert apart(line, done) < 1.0
    assert apart(done, line) < 1.0
    took = (at - first) + (over - again)
    assert last - first - 1.0 <= took <= last - first + WAY_BACK
