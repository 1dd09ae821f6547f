"""Ground robots of a world file: where they start, and what is refused in one sentence."""

from __future__ import annotations

import pytest
from pydantic import ValidationError

from missionkit.sim.world import World


def world(**parts: object) -> World:
    return World.model_validate({"world": "w", "start": [-9.0, 0.0], **parts})


def test_a_ring_heads_outwards_and_obstacles_along_their_circle():
    it = world(arena={"centre": [1, 2]}, robots={"count": 4, "ring": 3}, obstacle_robots={})
    east = it.target_starts[1]
    assert east.at == pytest.approx((1.0, 5.0))
    assert east.heading_deg == pytest.approx(90.0)
    first = it.obstacle_starts[0]
    assert first.at == pytest.approx((6.0, 2.0))
    assert first.heading_deg == pytest.approx(90.0)  # circles to its right, around the centre
    assert [one.tower for one in it.obstacle_starts] == [1.0, 1.35, 1.65, 2.0]


def test_without_robots_nothing_starts():
    it = world()
    assert (it.target_starts, it.obstacle_starts) == ((), ())


@pytest.mark.parametrize(
    ("parts", "says"),
    [
        ({"arena": {}, "robots": {"ring": 11}}, "robot 1 starts outside the arena, at 11, 0 m"),
        (
            {"arena": {}, "robots": {"placed": [{"at": [0, 0]}, {"at": [0, -11]}]}},
            "robot 2 starts outside the arena, at 0, -11 m",
        ),
        (
            {"obstacle_robots": {"placed": [{"at": [-9, 0.5]}]}},
            "obstacle robot 1 starts on the take-off point: 0.55 m apart at least",
        ),
        ({"robots": {"count": 3, "placed": [{"at": [0, 0]}]}}, "either count and ring, or placed"),
        (
            {"obstacle_robots": {"towers": [1], "placed": [{"at": [0, 0]}]}},
            "either count and towers, or placed",
        ),
        ({"robots": {"count": 0}}, "greater than or equal to 1"),
        ({"robots": {"plates": []}}, "at least 1 item"),
        ({"robots": {"plates": [256]}}, "less than or equal to 255"),
        ({"robots": {"placed": [{"at": [0, 0], "reversal": 21}]}}, "less than or equal to 20"),
        ({"obstacle_robots": {"towers": [0.05]}}, "greater than 0.1"),
        ({"obstacle_robots": {"circle": 0.1}}, "greater than or equal to 0.5"),
        ({"arena": {"goal": "up"}}, "'north', 'east', 'south' or 'west'"),
        ({"arena": {"side": 0}}, "greater than 0"),
    ],
)
def test_mistakes_are_refused(parts, says):
    with pytest.raises(ValidationError, match=says):
        world(**parts)
