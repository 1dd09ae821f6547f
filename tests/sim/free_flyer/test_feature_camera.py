from __future__ import annotations

import numpy as np
import pytest
from docking import Hand, perfect

from missionkit.docking_geometry import NORMALS
from missionkit.geometry import to_matrix, vec
from missionkit.messages import Command, Features
from missionkit.sim.free_flyer.feature_camera import features_of

ON = Command(payload="camera")


def shown(out: float, aside: float = 0.0, *faults: str, **parts: object) -> list[Features]:
    """Look at the target for a second from a place before its docking face."""
    place = Hand(perfect()).place(out, aside)
    start = {"position": tuple(place.tolist()), "attitude_deg": (-90.0, 0.0, -90.0)}
    hand = Hand(perfect(start=start, **parts), *faults)
    hand.flyer.apply(ON)
    hand.wait(1.0, lambda: ON)
    return [it for seen in hand.seen for it in seen.features]


def test_six_points_of_the_face_are_where_they_are():
    seen = shown(0.3)
    assert [it.at for it in seen] == pytest.approx([0.05 * n for n in range(1, 21)])
    assert all(it.names == tuple(f"top{n}" for n in range(1, 7)) for it in seen)
    assert {it.target for it in seen} == {"target"}
    target = perfect().target
    flat = np.array(target.features)  # docked without roll: along the camera's x and y
    away = np.full((6, 1), 0.3 + 0.01)  # from the camera, 1 cm behind the chaser's bottom
    assert seen[0].points == pytest.approx(np.hstack((flat, away)), abs=1e-12)


def test_points_are_those_of_the_table_from_anywhere():
    target = perfect().target
    table = features_of(target)
    seen = shown(0.3, 0.12)[0]
    place = Hand(perfect()).place(0.3, 0.12)
    axes = to_matrix(target.pose.rotation)
    camera = place + axes @ vec(0.0, 0.0, 0.04)
    for name, point in zip(seen.names, seen.points, strict=True):
        here = table.points[table.names.index(name)]
        assert camera + axes @ point == pytest.approx(target.pose.apply(here), abs=1e-12)


def test_faces_turned_towards_the_camera_are_seen():
    every = {**perfect().target.model_dump(), "lit": tuple(NORMALS)}
    faces = {name[:-1] for name in shown(0.3, 0.12, target=every)[0].names}
    assert faces == {"top", "front"}
    lit = {**perfect().target.model_dump(), "lit": ("top",)}
    assert {name[:-1] for name in shown(0.3, 0.12, target=lit)[0].names} == {"top"}


@pytest.mark.parametrize(
    ("out", "aside", "seen"),
    [(0.73, 0.0, True), (0.75, 0.0, False), (0.3, 0.25, True), (0.3, 0.26, False)],
)
def test_range_and_cone_of_view(out, aside, seen):
    """The target's centre is out + 0.06 m before the camera; tan 35° = 0.70 of that aside."""
    assert bool(shown(out, aside)) is seen


def test_it_is_on_while_a_command_names_it():
    place = Hand(perfect()).place(0.3)
    start = {"position": tuple(place.tolist()), "attitude_deg": (-90.0, 0.0, -90.0)}
    hand = Hand(perfect(start=start))
    hand.wait(0.5)
    hand.flyer.apply(ON)
    hand.wait(0.5)
    hand.flyer.apply(Command(payload="lamp"))
    hand.wait(0.5)
    times = [it.at for seen in hand.seen for it in seen.features]
    assert times == pytest.approx([0.05 * n for n in range(11, 21)])


def test_noise_has_its_size():
    seen = shown(0.3, sensors={"camera": {"sd": 0.001}})
    spread = np.array([it.points for it in seen]) - np.array(shown(0.3)[0].points)
    assert spread.std() == pytest.approx(0.001, rel=0.15)


def test_the_camera_fails_by_name():
    assert shown(0.3, 0.0, "camera_off") == []
    seen = shown(0.3, 0.0, "camera_frozen@0.5")
    assert [it.at for it in seen[10:]] == pytest.approx([0.45] * 10, abs=0.051)
    assert len(seen) == 20
