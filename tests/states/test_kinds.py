"""The kinds of state: P1's control modes, failsafes and invariants."""

from __future__ import annotations

import math

import pytest
from samples import calm

from missionkit.chart.plugin_catalogue import builtin
from missionkit.geometry import from_euler, vec
from missionkit.messages import Goal, Mode, Target
from missionkit.states import STATE_KINDS

PAPER = ("idle", "gps", "visual", "search", "task", "return", "land")


def test_every_kind_is_known_by_its_name_and_has_a_summary():
    assert set(STATE_KINDS) == {*PAPER, "hover", "custom", "logic"}
    for name, kind in STATE_KINDS.items():
        assert kind.name == name
        assert kind.summary.endswith(".")


def test_contracts_name_only_what_exists():
    catalogue = builtin()
    behaviors = catalogue.group("behaviors")
    for kind in STATE_KINDS.values():
        assert set(kind.must_reach) <= set(STATE_KINDS)
        assert kind.default_behavior is None or kind.default_behavior in behaviors
        assert kind.invariant is None or kind.invariant.to_kind in STATE_KINDS
        for failsafe in kind.failsafes:
            assert failsafe.to_kind in STATE_KINDS
            target = {"target": "t"} if failsafe.of_target else {}
            guard = catalogue.group("guards")[failsafe.use]
            assert guard(**failsafe.parameters, **target).kind == failsafe.use


def test_every_flying_kind_must_be_able_to_land():
    for kind in STATE_KINDS.values():
        assert not kind.flying or kind.name == "land" or "land" in kind.must_reach


def test_modes_are_those_of_the_paper():
    assert {name: kind.mode for name, kind in STATE_KINDS.items()} == {
        **dict.fromkeys(("idle", "land", "logic"), Mode.NONE),
        **dict.fromkeys(("gps", "return", "hover"), Mode.GPS),
        **dict.fromkeys(("visual", "task"), Mode.VISUAL),
        **dict.fromkeys(("search", "custom"), Mode.TRAJECTORY),
    }


def test_default_failsafes_are_those_of_the_paper():
    """Section 7.2: lock lost for 2.0 s, search for 30.0 s, goal out of reach.

    That a task is left when something pushes the vehicle is ours.
    """
    said = {
        name: [(one.use, one.parameters.get("longer_than"), one.to_kind) for one in kind.failsafes]
        for name, kind in STATE_KINDS.items()
        if kind.failsafes
    }
    lost, far = ("target_lost", 2.0, "search"), ("goal_unreachable", None, "hover")
    assert said == {
        "gps": [far],
        "visual": [lost, far],
        "search": [("elapsed", 30.0, "gps")],
        "task": [("disturbed", None, "visual"), lost],
        "return": [("goal_unreachable", None, "land")],
    }


def holds(kind: str, target: str | None = "t", **changes) -> bool | None:
    return STATE_KINDS[kind].invariant.check(calm(now=10.0, **changes), target).holds


def target(seen_at: float | None) -> dict[str, Target]:
    return {"t": Target("t", vec(5, 0, -5), 0.1, None, None, seen_at)}


def test_gps_needs_a_goal():
    assert holds("gps", targets=target(None)) is True
    assert holds("gps") is False
    assert holds("gps", target=None) is True


@pytest.mark.parametrize(
    ("seen_at", "expected"), [(10.0, True), (9.5, True), (9.45, False), (None, False)]
)
def test_visual_needs_the_marker_in_sight(seen_at, expected):
    assert holds("visual", targets=target(seen_at)) is expected


def test_visual_without_a_target_has_nothing_to_lose():
    assert holds("visual", target=None) is True
    assert holds("visual") is False


@pytest.mark.parametrize(
    ("east", "yaw_deg", "expected"),
    [
        *[(0.099, 0.0, True), (0.101, 0.0, False), (0.0, 4.9, True), (0.0, 5.1, False)],
        *[(0.0, -4.9, True), (0.0, 355.1, True), (0.0, 354.9, False), (0.099, 4.9, True)],
    ],
)
def test_the_task_needs_the_goal_within_a_tenth_of_a_metre_and_five_degrees(
    east, yaw_deg, expected
):
    goal = Goal(vec(0, 0, -5), 0.0, 10.0)
    turned = from_euler(0.0, 0.0, math.radians(yaw_deg))
    seen = {"position": vec(0, east, -5), "attitude": turned, "goal": goal}
    assert holds("task", **seen) is expected


def test_a_task_whose_goal_has_no_heading_is_judged_by_its_place():
    goal = Goal(vec(0, 0, -5), None, 10.0)
    assert holds("task", goal=goal, attitude=from_euler(0, 0, 2.0)) is True
    assert holds("task", goal=None) is None


def test_a_distance_just_above_its_limit_is_not_written_as_the_limit():
    seen = calm(position=vec(0, 0.1004, -5), goal=Goal(vec(0, 0, -5), None, 10.0))
    verdict = STATE_KINDS["task"].invariant.check(seen, None)
    assert verdict.why == "0.1004 m from its goal, more than 0.1 m"
