"""One run of a campaign: the flight that `missionkit run` flies, without its folder."""

from __future__ import annotations

import shutil
import traceback
from collections.abc import Mapping
from contextlib import ExitStack
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

from missionkit.campaigns.run_row import (
    Case,
    Row,
    RunOrder,
    unflown,
)
from missionkit.campaigns.visit_log import VisitLog
from missionkit.chart.load import load
from missionkit.chart.model.mission import Mission
from missionkit.chart.plugin_catalogue import Catalogue, builtin
from missionkit.engine.clock import date
from missionkit.engine.flight_loop import Observer, Operator
from missionkit.engine.planned_events import PlannedEvents, planned
from missionkit.outcome import outcome, reason
from missionkit.recorder.flight_recorder import FlightRecorder
from missionkit.recorder.geographic_messages import Georeference
from missionkit.recorder.scenery import scenery_of
from missionkit.rehearsal.grading import Rehearsal
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import Stage, stage, world_of
from missionkit.sim.fault_injection import Fault, parse_fault
from missionkit.sim.flight_grading import Grade
from missionkit.sim.world_files import AnyWorld


class VariantMission(NamedTuple):
    """A mission with the parameters of one variant."""

    mission: Mission
    catalogue: Catalogue
    world: AnyWorld
    faults: tuple[Fault, ...]


def fly(order: RunOrder, case: Case) -> Row:
    """Fly one run and return its row; errors are reported in the row."""
    try:
        return _row(order, case)
    except Exception as error:  # noqa: BLE001 - a run that breaks is a result, not the end
        where = traceback.extract_tb(error.__traceback__)[-1]
        place = f"{Path(where.filename).name}:{where.lineno}"
        return unflown(case, "error", f"{type(error).__name__}: {error} ({place})")


def loaded(order: RunOrder, settings: Mapping[str, str]) -> VariantMission:
    """Return the mission of a variant; read once by each process.

    Raises:
        MissionkitError: the mission, its world, a plug-in or a fault cannot be used.
    """
    return _loaded(
        order.mission, order.plugins, order.faults, tuple({**order.settings, **settings}.items())
    )


@lru_cache(maxsize=64)
def _loaded(
    path: str,
    plugins: tuple[str, ...],
    faults: tuple[str, ...],
    settings: tuple[tuple[str, str], ...],
) -> VariantMission:
    catalogue = builtin().with_entry_points()
    for file in plugins:
        catalogue = catalogue.with_file(Path(file))
    mission = load(Path(path), catalogue, dict(settings))
    world = world_of(mission, Path(path).parent)
    return VariantMission(mission, catalogue, world, tuple(map(parse_fault, faults)))


def _row(order: RunOrder, case: Case) -> Row:
    mission, catalogue, world, faults = loaded(order, case.settings)
    ready = stage(mission, catalogue, world, case.seed, faults)
    diary = VisitLog(ready.plan.period)
    operator = Operator()
    due = [planned(text, mission.by_name()) for text in order.events]
    observers: list[Observer] = [diary, PlannedEvents(due, operator)]
    folder = Path(order.records, str(case.number)) if order.records else None
    result = _flown(ready, observers, operator, folder)
    return Row(
        number=case.number,
        variant=case.variant,
        seed=case.seed,
        settings=dict(case.settings),
        outcome=outcome(result),
        reason=reason(result),
        conditions={it.says: it.met for it in result.conditions},
        requirements={it.name: (it.fulfilled, it.robustness) for it in result.requirements},
        parameters=dict(mission.params),
        metrics={"duration": result.flown.duration, **metrics(result.grade)},
        times=diary.times,
        transitions=diary.transitions,
        ways=diary.ways,
        entries=diary.entries,
        visits=diary.visits,
        problems=diary.problems,
    )


def _flown(
    ready: Stage, observers: list[Observer], operator: Operator, folder: Path | None
) -> Rehearsal:
    with ExitStack() as stack:
        if folder is not None:
            shutil.rmtree(folder, ignore_errors=True)  # of a campaign that was killed
            folder.mkdir(parents=True)
            scenery = scenery_of(ready.world)
            recorder = FlightRecorder(
                folder,
                camera=ready.plan.camera,
                scenery=scenery,
                known=ready.plan.map,
                reference=Georeference.fixed(ready.mission.geodetic_origin, date),
            )
            stack.enter_context(recorder)
            observers.append(
                lambda record, seen: recorder.write(record, seen.frame, ready.vehicle.truth)
            )
        return rehearse(ready, observers, operator=operator)


def metrics(grade: Grade) -> dict[str, float | None]:
    """Return the numbers of a grade: m, s, J, rad; None where there was nothing to measure."""
    graded = grade.as_dict()
    visit = graded["visit"] or {}
    return {
        "clearance": graded["clearance"],
        "distance": grade.distance,
        "armed": grade.duration,
        "energy": grade.energy,
        "position_error": visit.get("position_error"),
        "yaw_error": visit.get("yaw_error"),
        "worst_error": visit.get("worst_error"),
        "worst_sideways": visit.get("worst_sideways"),
        "estimate_error": grade.estimate_error,
        "landing_error": grade.landing_error,
        "robots_home": None if grade.herd is None else float(grade.herd.home),
        "robots_lost": None if grade.herd is None else float(grade.herd.lost),
    }
