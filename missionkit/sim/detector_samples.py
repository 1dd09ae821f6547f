"""What detectors of ground robots are trained and tested on: rendered pictures with their truth."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, Final

import numpy as np

from missionkit.geometry import Mat
from missionkit.perception.apparent_size import size_gate
from missionkit.perception.detector_sample import Sample
from missionkit.perception.square_pose import project
from missionkit.sim.robot_look import ROBOT, RobotLook
from missionkit.sim.robot_views import Domain, RobotView, floors, robot_views
from missionkit.sim.world import World

MARGIN: Final = 4.0  # px, k of P4
ALONG_TOWER: Final = 8  # places along a tower that are neither a robot nor none

TRAINING: Final = Domain(
    floors(("grid", "concrete", "soil", "gravel")),
    plates=(45.0, 215.0),
    light=(0.5, 1.4),
    shadow=(0.45, 0.9),
    shadows=0.8,
    blur=(0.0, 1.0),
)
"""What the shipped detectors are trained on."""

_OTHER: Final[Mapping[str, Mapping[str, Any]]] = {
    "other floors": {"worlds": floors(("lines", "grass"))},
    "other light": {"light": (0.38, 0.5), "shadow": (0.35, 0.45), "shadows": 1.0},
    "other plates": {"plates": (215.0, 250.0)},
    "another lens": {"distortion": (-0.25, 0.08, 0.001, -0.001, 0.0), "focal": (220.0, 250.0)},
    "more blur": {"blur": (1.0, 1.4), "exposure": (0.008, 0.012)},
}


def variations_of(domain: Domain) -> dict[str, Domain]:
    """Return domains that differ from one that was trained on, by what they differ in."""
    everything = {key: it for changes in _OTHER.values() for key, it in changes.items()}
    changes: Mapping[str, Mapping[str, Any]]
    changes = {"as trained": {}, **_OTHER, "all at once": everything}
    return {name: domain._replace(**it) for name, it in changes.items()}


def of_worlds(worlds: Sequence[World]) -> Domain:
    """Return the domain of these worlds' floors, lines and plates; of none, `TRAINING`."""
    if not worlds:
        return TRAINING
    painted = [it.robots.plates for it in worlds if it.robots is not None]
    plates = [float(level) for levels in painted for level in levels]
    domain = TRAINING._replace(worlds=tuple(worlds))
    return domain._replace(plates=(min(plates), max(plates))) if plates else domain


def samples(domain: Domain, count: int, seed: int, margin: float = MARGIN) -> Iterator[Sample]:
    """Yield pictures with what a detector should find in them.

    Args:
        domain: what they differ in.
        count: of pictures.
        seed: of all chance.
        margin: px, k of the sizes that are searched for.
    """
    for view in robot_views(domain, count, seed):
        found = sample_of(view, margin)
        if found is not None:
            yield found


def sample_of(view: RobotView, margin: float = MARGIN) -> Sample | None:
    """Return a picture with what a detector should find in it; None: nothing of that size.

    Robots that are wholly in the picture must be found. Those cut by its edge, and obstacle
    robots, whose towers hide them, count neither way.
    """
    gate = size_gate(
        view.camera, view.body, 0.0, diameter=ROBOT.diameter, top=ROBOT.height, margin=margin
    )
    spans = None if gate is None else gate.spans(view.camera)
    if gate is None or spans is None:
        return None
    places: list[Mat] = []
    others: list[tuple[float, float, float]] = []
    for robot, place in zip(view.robots, view.places, strict=True):
        half = 0.5 * gate.width(*place.tolist())
        if robot.tower:
            others += [(*spot, half) for spot in _along_tower(view, robot).tolist()]
        elif _within(view, place, half):
            places.append(place)
        else:
            others.append((*place.tolist(), half))
    return Sample(
        view.image,
        gate,
        spans,
        np.array(places).reshape(-1, 2),
        np.array(others).reshape(-1, 3),
    )


def _within(view: RobotView, place: Mat, half: float) -> bool:
    size = np.array([view.camera.width - 1.0, view.camera.height - 1.0])
    return bool((place >= half).all() and (place <= size - half).all())


def _along_tower(view: RobotView, robot: RobotLook) -> Mat:
    """Return places (n, 2), px, from a robot's top to that of its tower."""
    down = np.linspace(-ROBOT.height, -robot.tower, ALONG_TOWER)
    points = np.column_stack([np.full(ALONG_TOWER, robot.north), np.full(ALONG_TOWER, robot.east)])
    eye = (view.body @ view.camera.mount).inverse()
    return project(np.column_stack([points, down]), eye, view.camera)
