"""`missionkit fleet --runs`: a fleet flown with many seeds, and its conflicts counted."""

from __future__ import annotations

import json
import multiprocessing
import signal
from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from typing import NamedTuple

from missionkit.api.campaign import cores
from missionkit.campaigns.fleet_statistics import FleetStatistics, fleet_statistics
from missionkit.campaigns.number_format import between, percent
from missionkit.cli.fleet_in_simulator import fleet_summary, staged
from missionkit.cli.fleet_members import FleetOptions, Member, members_of
from missionkit.errors import ExitCode, VehicleError
from missionkit.recorder.fleet_summary import FleetSummary
from missionkit.recorder.run_folder import run_folder, write_whole
from missionkit.rehearsal.fleet import rehearse_fleet
from missionkit.sim.separation import time_in_air

FLIGHTS, RESULT = "flights.jsonl", "summary.json"


class OneRun(NamedTuple):
    """Result of one seed."""

    summary: FleetSummary
    seconds: float  # in the air, until the last vehicle has landed


def fly_many(wanted: FleetOptions, members: Sequence[Member]) -> ExitCode:
    """Fly the seeds from `wanted.seed` on; leave a line for each and the statistics.

    Args:
        wanted: options of the command, with the number of runs.
        members: of the fleet, checked.

    Raises:
        FileError: a world cannot be used.
        UsageError: a fault does not fit, or the vehicles cannot fly together.
        VehicleError: a process died.
    """
    staged(members, wanted.seed)  # refuses here what would be refused in every process
    folder = run_folder(wanted.out, "fleet", f"campaign-seed{wanted.seed}")
    seeds = range(wanted.seed, wanted.seed + (wanted.runs or 1))
    found: list[OneRun] = []
    try:
        with (folder / FLIGHTS).open("w", encoding="utf-8") as journal:
            for one in _flown(wanted, seeds):
                found.append(one)
                journal.write(one.summary.model_dump_json() + "\n")
                journal.flush()
    except KeyboardInterrupt:
        if not found:
            raise
    results = fleet_statistics([it.summary for it in found], sum(it.seconds for it in found) / 3600)
    write_whole(folder / RESULT, json.dumps(_plain(results, wanted), indent=2) + "\n")
    if wanted.as_json:
        print(json.dumps({**_plain(results, wanted), "folder": str(folder)}, indent=2))  # noqa: T201
    else:
        print("\n".join([*_lines(results, wanted), str(folder)]))  # noqa: T201
    return ExitCode.SUCCESS if len(found) == len(seeds) else ExitCode.ENDED_SAFELY


def _flown(wanted: FleetOptions, seeds: Sequence[int]) -> Iterator[OneRun]:
    workers = min(wanted.workers or cores(), len(seeds))
    if workers == 1:
        yield from map(partial(fly_one, wanted), seeds)
        return
    processes = multiprocessing.get_context("forkserver")
    processes.set_forkserver_preload(["missionkit.campaigns.worker_preload"])
    with ProcessPoolExecutor(workers, processes, _deaf) as pool:
        try:
            for done in as_completed([pool.submit(fly_one, wanted, seed) for seed in seeds]):
                yield done.result()
        except BrokenProcessPool as error:
            raise VehicleError("a process that flew the fleet died") from error
        finally:
            pool.shutdown(wait=False, cancel_futures=True)


def _deaf() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C is the parent's to answer


def fly_one(wanted: FleetOptions, seed: int) -> OneRun:
    """Fly one seed without a record.

    Args:
        wanted: options of the command.
        seed: of everything random.
    """
    wanted = wanted._replace(seed=seed)
    members = members_of(wanted)
    stages = staged(members, seed, anyway=wanted.anyway)
    flown = rehearse_fleet(stages, {}, separation=wanted.separation)
    seconds = max(time_in_air(ready.vehicle.track.rows) for ready in stages.values())
    return OneRun(fleet_summary(wanted, members, flown, landing=False), seconds)


def _lines(found: FleetStatistics, wanted: FleetOptions) -> Iterator[str]:
    near = f"nearer than {wanted.separation:g} m by ground truth"
    share = f"{percent(found.in_conflict.value)}, {between(found.in_conflict, percent)}"
    yield f"{found.runs} runs, {found.conflicts} conflicts ({near})"
    yield f"  runs with a conflict: {share}"
    yield f"  conflicts per hour of flight: {found.rate.value:.3g}, {between(found.rate, _short)}"
    yield f"  runs with a collision: {percent(found.collided.value)}, " + between(
        found.collided, percent
    )
    if found.least is not None:
        yield f"  least distance of two vehicles in the air: {found.least:.1f} m"
    for name, rate in found.success.items():
        yield f"  {name}: success {percent(rate.value)}, {between(rate, percent)}"


def _short(value: float) -> str:
    return f"{value:.3g}"


def _plain(found: FleetStatistics, wanted: FleetOptions) -> dict[str, object]:
    rates = {name: it._asdict() for name, it in found.success.items()}
    return {
        "runs": found.runs,
        "seed": wanted.seed,
        "separation": wanted.separation,
        "conflicts": found.conflicts,
        "in_conflict": found.in_conflict._asdict(),
        "conflicts_per_hour": found.rate._asdict(),
        "collided": found.collided._asdict(),
        "success": rates,
        "least": found.least,
    }
