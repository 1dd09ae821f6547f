"""Rules for targets that are tracked: found in flight, at no place that the mission file knows."""

from __future__ import annotations

from collections.abc import Iterator

from missionkit.chart.model.mission import Mission
from missionkit.errors import Problem
from missionkit.messages import names_a_track
from missionkit.states import VEHICLES


def problems_of(mission: Mission) -> Iterator[Problem]:
    """Yield each use of a tracked target's name that asks for a place known before the flight."""
    tracking = mission.tracking
    if tracking is None:
        return
    if not VEHICLES[mission.vehicle.use].over_ground:
        message = (
            f"a {mission.vehicle.use!r} flies over no ground on which targets could be tracked"
        )
        yield Problem(mission.place("tracking"), message)
    for name in filter(names_a_track, mission.targets):
        message = f"target {name!r}: the tracker gives this name to what it finds; choose another"
        yield Problem(mission.targets[name].place(), message)
    yield from _markers(mission)
    yield from _success(mission)


def _markers(mission: Mission) -> Iterator[Problem]:
    for it in mission.perception:
        name = str(getattr(it.plugin, "target", ""))
        if names_a_track(name):
            message = f"detector {it.kind!r}: {name!r} is tracked; a marker belongs to a target of "
            yield Problem(it.place, message + "'targets'")


def _success(mission: Mission) -> Iterator[Problem]:
    for one in mission.success:
        for key, name in (("target", one.target), ("docked", one.docked)):
            if name is not None and names_a_track(name):
                message = (
                    f"success: {name!r} is tracked, so no file says where it truly is; name a "
                )
                yield Problem(one.place(key), message + "target of 'targets'")
