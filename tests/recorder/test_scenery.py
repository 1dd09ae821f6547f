from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from missionkit.messages import Verdict
from missionkit.recorder.json_fragments import verdict
from missionkit.recorder.scenery import DrawnBox, Round, scenery_of
from missionkit.sim.world import World


def test_a_world_becomes_scenery():
    south = np.array([0.5, -0.5, -0.5, 0.5])
    world = SimpleNamespace(
        obstacles=(
            SimpleNamespace(use="cylinder", at=(25.0, 1.5), radius=0.8, height=9.0),
            SimpleNamespace(use="box", min=(58.0, 8.0), max=(60.0, 14.0), bottom=1.0, height=8.0),
            SimpleNamespace(use="sphere", at=(5.0, 6.0, -7.0), radius=2.0),
        ),
        markers=(SimpleNamespace(id=23, size=0.4, position=(84.0, 12.0, -2.4), attitude=south),),
    )
    scenery = scenery_of(world)
    assert scenery.obstacles == (
        Round((25.0, 1.5), 0.8, 0.0, 9.0),
        DrawnBox((58.0, 8.0), (60.0, 14.0), 1.0, 8.0),
        Round((5.0, 6.0), 2.0, 5.0, 9.0, ball=True),
    )
    (marker,) = scenery.markers
    assert marker.name == "marker 23"
    np.testing.assert_allclose(marker.normal, (-1.0, 0.0, 0.0), atol=1e-12)


def test_footprints_have_the_size_of_the_obstacle():
    circle = Round((10.0, 20.0), 3.0, 0.0, 5.0).footprint()
    np.testing.assert_allclose(np.hypot(*(circle - (10.0, 20.0)).T), 3.0)
    box = DrawnBox((0.0, 1.0), (2.0, 5.0), 0.0, 3.0).footprint()
    np.testing.assert_allclose(np.ptp(box, axis=0), (2.0, 4.0))


def test_a_verdict_keeps_every_digit_and_drops_what_is_not_finite():
    said = Verdict(holds=np.True_, why='odd "quotes"', value=0.1 + 0.2, threshold=float("nan"))
    assert verdict("g", said) == (
        '{"name":"g","holds":"yes","value":0.30000000000000004,"why":"odd \\"quotes\\""}'
    )


def test_an_arena_has_its_goals_side():
    arena = {"centre": (1.0, 2.0), "side": 4.0, "goal": "east"}
    drawn = scenery_of(World.model_validate({"world": "w", "arena": arena})).arena
    assert drawn is not None
    assert sorted(drawn.goal.tolist()) == [[-1.0, 4.0], [3.0, 4.0]]
