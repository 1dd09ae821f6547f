"""Many flights of one mission, and what they prove."""

from __future__ import annotations

import os
import sys
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path

from missionkit.api.missions import LoadedMission, as_yaml, assemble, refuse
from missionkit.api.simulation import fault_of
from missionkit.campaigns import process_pool, run_journal
from missionkit.campaigns.analysis import Analysis, analysed
from missionkit.campaigns.campaign_loop import conduct, counted
from missionkit.campaigns.campaign_plan import (
    PLAN_FILE,
    Campaign,
    Rule,
    digest_of,
    found,
    keep,
)
from missionkit.campaigns.campaign_report import write_report
from missionkit.campaigns.campaign_summary import write_summary
from missionkit.campaigns.progress_line import CampaignProgress
from missionkit.campaigns.run_row import Row
from missionkit.campaigns.variants import Axis, variants
from missionkit.chart.load import load
from missionkit.engine.clock import stopwatch
from missionkit.engine.planned_events import planned as planned_event
from missionkit.errors import UsageError
from missionkit.recorder.run_folder import keep_mission
from missionkit.rehearsal.stage import world_of

NO_VARIANTS: Mapping[str, Sequence[object]] = {}


def campaign(
    mission: LoadedMission,
    folder: str | Path,
    *,
    runs: int = 100,
    seed: int = 0,
    vary: Mapping[str, Sequence[object]] = NO_VARIANTS,
    faults: Sequence[str] = (),
    events: Sequence[str] = (),
    workers: int | None = None,
    timeout: float = 300.0,
    require: float | None = None,
    records: bool = False,
    progress: bool = False,
) -> Analysis:
    """Fly a mission many times in the simulator, like `missionkit campaign`, and summarise it.

    Flights run in several processes, so a script has to call this below
    `if __name__ == "__main__":`. They read the mission again from its file: plug-ins have to come
    from installed packages or from files, not from classes given to `load`.

    Args:
        mission: a mission returned by `load`.
        folder: where journal, table, summary and report are left; it must not hold a campaign.
        runs: flights of each variant.
        seed: seed of the first flight; flight number n has seed + n.
        vary: values of parameters by name; every combination is a variant, and all variants fly
            the same seeds.
        faults: faults to inject in every flight, as for `--fault`.
        events: events of the operator in every flight, as for `--event`.
        workers: number of processes; one per core if absent.
        timeout: s of wall time after which a flight is aborted.
        require: success rate, 0 to 1; stop as soon as it is shown or refuted (Wald's sequential
            test with a risk of 5 % of either error).
        records: keep the flight record of every run.
        progress: show the progress on stderr.

    Returns:
        Success rates with their 95 % intervals (Wilson), outcomes, measured numbers and their
        quantiles of each variant, the variants compared seed by seed, and the worst flights.

    Raises:
        FileError: the mission cannot be used with one of the values.
        UsageError: an argument does not fit, or the folder holds a campaign already.

    Example:
        >>> analysis = missionkit.campaign(mission, "runs/cruise", runs=1, vary={"cruise": [4, 6]})
        >>> [(it.name, it.success.value, round(it.success.low, 2)) for it in analysis.variants]
        [('cruise = 4', 1.0, 0.21), ('cruise = 6', 1.0, 0.21)]
    """
    root = Path(folder)
    if (root / PLAN_FILE).exists():
        raise UsageError(f"{root}: already holds a campaign: choose another folder")
    axes = tuple((name, tuple(as_yaml({name: it})[name] for it in vary[name])) for name in vary)
    plan = planned(
        mission.path,
        mission.settings,
        axes,
        plugins=_files(mission),
        faults=faults,
        events=events,
        seed=seed,
        runs=runs,
        timeout=timeout,
        rule=rule_of(require=require),
        records=records,
    )
    root.mkdir(parents=True, exist_ok=True)
    keep_mission(root, mission.path)
    keep(root, plan)
    crew = partial(
        process_pool.flown, plan.order(root), workers=workers or cores(), timeout=plan.timeout
    )
    show = (
        CampaignProgress(sys.stderr, stopwatch, [], plan.runs * plan.variants) if progress else None
    )
    conduct(plan, root, crew, show or _silent)
    if show is not None:
        show.finish()
    return reported(root)


def planned(
    path: Path,
    settings: Mapping[str, str],
    vary: Sequence[Axis],
    *,
    plugins: Sequence[Path] = (),
    faults: Sequence[str] = (),
    events: Sequence[str] = (),
    seed: int,
    runs: int,
    timeout: float,
    rule: Rule,
    records: bool,
) -> Campaign:
    """Check everything that every variant needs; return the plan of the campaign.

    Args:
        path: of the mission.
        settings: values of parameters, in YAML, that all variants have.
        vary: parameters that variants differ in.
        plugins: files.
        faults: as `--fault` takes them.
        events: as `--event` takes them.
        seed: of the first run.
        runs: of each variant.
        timeout: s of wall time a run may take.
        rule: when to stop before all runs are flown.
        records: keep every flight record.

    Raises:
        FileError: mission, world or plug-in file cannot be used.
        UsageError: a fault or an event is not known or does not fit.
    """
    catalogue = assemble(plugins)
    mission = None
    for chosen in variants(vary):
        mission = load(path, catalogue, {**settings, **chosen})
        refuse(mission, catalogue)
    assert mission is not None  # noqa: S101 - there is always a variant
    world = world_of(mission, path.parent)
    for text in faults:
        fault_of(text, mission, world)
    for text in events:
        planned_event(text, mission.by_name())
    return Campaign(
        mission=str(path.resolve()),
        name=mission.name,
        settings=dict(settings),
        plugins=tuple(str(it.resolve()) for it in plugins),
        faults=tuple(faults),
        events=tuple(events),
        vary=tuple(vary),
        seed=seed,
        runs=runs,
        timeout=timeout,
        rule=rule,
        digest=digest_of(mission, path, tuple(plugins)),
        records=records,
    )


def rule_of(
    *, width: float | None = None, require: float | None = None, better: float | None = None
) -> Rule:
    """Return when a campaign stops before all runs are flown.

    Args:
        width: of the success rate's interval.
        require: success rate to be exceeded.
        better: the alternative rate that `require` is tested against; half the failures if absent.

    Raises:
        UsageError: the rates do not fit together.
    """
    rule = Rule(width=width, require=require, better=better)
    if require is not None and not require < rule.hoped < 1.0:
        raise UsageError("--require must be below --better, and both below 1")
    if require is None and better is not None:
        raise UsageError("--better needs --require")
    return rule


def reported(folder: Path) -> Analysis:
    """Write table, summary and page from the journal of a campaign; return what they say.

    Raises:
        UsageError: the folder holds no campaign, or none of its runs has ended.
    """
    plan = found(folder)
    rows = counted(run_journal.read(folder), plan)
    if not rows:
        raise UsageError(f"{folder}: no run has finished yet")
    run_journal.write(folder, rows)
    analysis = analysed(plan, rows)
    write_summary(folder, analysis)
    write_report(folder, analysis)
    return analysis


def cores() -> int:
    """Return how many processes this one may run at a time."""
    return len(os.sched_getaffinity(0))


def _files(mission: LoadedMission) -> tuple[Path, ...]:
    classes = [it.__name__ for it in mission.plugins if not isinstance(it, Path)]
    if classes:
        raise UsageError(
            f"a campaign cannot use the class {classes[0]}: its workers load plug-ins from files "
            "or installed packages; put it in a file and load the mission with that file"
        )
    return tuple(it for it in mission.plugins if isinstance(it, Path))


def _silent(_: Row) -> None:
    """Show nothing."""
