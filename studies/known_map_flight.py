"""One flight past the two walls, judged by ground truth."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from missionkit.chart.load import load
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import builtin
from missionkit.geometry import Mat
from missionkit.messages import Observation, Record
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import stage, world_of
from studies.parallel import in_parallel

MISSION = Path("missions/known_map.yaml")
STATE = "path"
VARIANTS = {
    "classical": {"neighbours": "4", "heuristic": "manhattan"},
    "modified": {"neighbours": "8", "heuristic": "euclidean"},
    "modified, smoothed": {"neighbours": "8", "heuristic": "euclidean", "smooth": "true"},
}
"""P2's two, and lines of sight: `--set` by name."""


class Run(NamedTuple):
    """Result of one flight, from the first plan to the goal."""

    variant: str
    seed: int
    succeeded: bool
    clearance: float  # m, from the vehicle's surface, least
    length: float  # m, flown in truth
    duration: float  # s
    plans: int
    drift: float  # m, level, estimate less truth, largest
    missed: float  # m, level, from the goal at the end
    places: Mat  # (N, 2), m, north and east in truth


def mission_of(variant: str) -> Mission:
    """Return the mission with a variant of A*."""
    return load(MISSION, builtin(), VARIANTS[variant])


def flown(order: tuple[str, int]) -> Run:
    """Fly one variant with one seed."""
    variant, seed = order
    mission = mission_of(variant)
    ready = stage(mission, builtin(), world_of(mission, MISSION.parent), seed)
    times: list[float] = []
    drifts: list[float] = []
    heard: list[str] = []

    def watch(record: Record, _: Observation) -> None:
        heard.extend(record.estimate.events)
        if record.state == STATE:
            times.append(record.now)
            off = record.estimate.position - ready.vehicle.truth.position
            drifts.append(float(np.hypot(off[0], off[1])))

    result = rehearse(ready, (watch,))
    rows = ready.vehicle.track.rows
    rows = rows[(rows[:, 0] >= times[0]) & (rows[:, 0] <= times[-1])]
    places = rows[:, 1:3]
    goal = mission.targets["goal"].position
    return Run(
        variant,
        seed,
        result.succeeded,
        clearance=float(rows[:, 19].min()),
        length=float(np.hypot(*np.diff(places, axis=0).T).sum()),
        duration=times[-1] - times[0],
        plans=heard.count("path.planned"),
        drift=max(drifts),
        missed=float(np.hypot(*(places[-1] - goal[:2]))),
        places=places[::4].copy(),
    )


def fly_all(seeds: Sequence[int], workers: int) -> Iterator[Run]:
    """Fly every variant with every seed; yield in that order."""
    orders = [(variant, seed) for variant in VARIANTS for seed in seeds]
    return in_parallel(flown, orders, workers, chunk=4)
