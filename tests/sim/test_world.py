from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import yaml
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from missionkit.geometry import to_matrix
from missionkit.sim.obstacle_distance import nearest_gap, table
from missionkit.sim.world import World, marker_attitude

ANGLES = st.floats(-180.0, 180.0)


def test_upright_marker_axes() -> None:
    # seen from the south: right is east, up is up, out is south
    expected = np.column_stack(([0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [-1.0, 0.0, 0.0]))
    assert to_matrix(marker_attitude(180.0)) == pytest.approx(expected)


def test_marker_on_the_ground_faces_up_with_its_top_away() -> None:
    flat = to_matrix(marker_attitude(0.0, 90.0))
    assert flat[:, 2] == pytest.approx([0.0, 0.0, -1.0])
    assert flat[:, 1] == pytest.approx([-1.0, 0.0, 0.0])


def test_roll_turns_clockwise_for_the_viewer() -> None:
    rolled = to_matrix(marker_attitude(180.0, 0.0, 90.0))
    assert rolled[:, 1] == pytest.approx([0.0, 1.0, 0.0])


@given(ANGLES, st.floats(-85.0, 85.0), ANGLES)
def test_normal_has_heading_and_elevation(facing: float, tilt: float, roll: float) -> None:
    turned = to_matrix(marker_attitude(facing, tilt, roll))
    f, e = np.radians(facing), np.radians(tilt)
    normal = [np.cos(e) * np.cos(f), np.cos(e) * np.sin(f), -np.sin(e)]
    assert np.linalg.det(turned) == pytest.approx(1.0)
    assert turned[:, 2] == pytest.approx(normal, abs=1e-9)


@pytest.mark.parametrize(
    ("part", "complaint"),
    [
        ({"obstacles": [{"use": "cone"}]}, "'cylinder', 'box', 'sphere'"),
        ({"windy": 3}, "Extra inputs"),
        ({"wind": {"gust": -1.0}}, "greater than or equal to 0"),
        (
            {"obstacles": [{"use": "box", "min": [1, 0], "max": [0, 1], "height": 2}]},
            "min must be south and west",
        ),
        (
            {"obstacles": [{"use": "box", "min": [0, 0], "max": [1, 1], "height": 2, "bottom": 3}]},
            "bottom must be below",
        ),
        ({"ground": {"texture": "lava"}}, "'grass', 'soil'"),
        ({"quadrotor": {"inertia": [0, 0.1, 0.1]}}, "greater than 0"),
        ({"quadrotor": {"inertia": [0.1, 0.1, -1]}}, "greater than 0"),
        ({"quadrotor": {"mass": 1e-9}}, "too small for this drag: at least 0.016 kg"),
        ({"quadrotor": {"drag_linear": 1e9}}, "too small for this drag"),
        ({"start": [0.0, float("nan")]}, "finite"),
        ({"sensors": {"gnss": {"rate": 1e9}}}, "less than or equal to 200"),
    ],
)
def test_mistakes_are_refused(part: dict[str, object], complaint: str) -> None:
    with pytest.raises(ValidationError, match=complaint):
        World.model_validate({"world": "bad", **part})


def test_the_orchard_is_a_world_with_its_marker_in_front_of_the_trunk() -> None:
    text = Path(__file__).parents[2].joinpath("missions/worlds/orchard.yaml").read_text("utf-8")
    world = World.model_validate(yaml.safe_load(text))
    marker = world.marker(23, "DICT_6X6_250")
    assert marker is not None
    gap = nearest_gap(table(world), marker.position[0], marker.position[1], -marker.position[2])
    assert 0.0 < gap < 0.1


def test_marker_is_found_by_id_and_dictionary() -> None:
    board = {"size": 0.2, "position": [1, 0, 0]}
    names = ("DICT_4X4_50", "DICT_6X6_250")
    markers = [{**board, "dictionary": name, "id": 1} for name in names]
    world = World.model_validate({"world": "w", "markers": markers})
    assert world.marker(1) is world.markers[0]
    assert world.marker(1, "DICT_6X6_250") is world.markers[1]
    assert world.marker(2) is None


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"dictionary": "DICT_6X6_25"}, "did you mean 'DICT_6X6_250'"),
        ({"id": 250}, "DICT_6X6_250 has ids 0 to 249, not 250"),
    ],
)
def test_an_implausible_marker_size_is_refused(change, says) -> None:
    board = {"dictionary": "DICT_6X6_250", "id": 1, "size": 0.2, "position": [1, 0, 0]}
    with pytest.raises(ValidationError, match=says):
        World.model_validate({"world": "w", "markers": [{**board, **change}]})


@pytest.mark.parametrize(
    ("obstacle", "stands"),
    [
        ({"use": "cylinder", "at": [3.0, 0.0], "radius": 0.6, "height": 2.0}, True),
        ({"use": "cylinder", "at": [3.0, 1.0], "radius": 0.6, "height": 2.0}, False),
        ({"use": "box", "min": [2.5, -9.0], "max": [2.7, 9.0], "height": 2.0}, True),
        ({"use": "box", "min": [1.0, -9.0], "max": [1.4, 9.0], "height": 2.0}, False),
        ({"use": "box", "min": [2.0, -1], "max": [4.0, 1], "height": 2.0, "bottom": 1.0}, False),
        ({"use": "sphere", "at": [2.0, 0.0, -0.5], "radius": 0.3}, True),
        ({"use": "sphere", "at": [2.0, 0.0, -2.0], "radius": 0.3}, False),
    ],
)
def test_the_take_off_point_is_free(obstacle, stands) -> None:
    data = {"world": "w", "start": [2.0, 0.0], "obstacles": [obstacle]}
    near = {**data, "quadrotor": {"radius": 0.5}}
    if stands:
        with pytest.raises(ValidationError, match=f"obstacle 1 .{obstacle['use']}. stands on"):
            World.model_validate(near)
    else:
        assert World.model_validate(near).obstacles
