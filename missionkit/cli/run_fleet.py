"""`missionkit fleet`: several missions at once, each with its own vehicle."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from missionkit.cli.fleet_members import FleetOptions, Member, members_of
from missionkit.errors import ExitCode, UsageError, printable
from missionkit.recorder.fleet_summary import FleetSummary, write_fleet_summary
from missionkit.recorder.run_folder import run_folder


def fleet(wanted: FleetOptions) -> ExitCode:
    """Fly a fleet; leave a folder with one folder for each vehicle and a summary.

    Raises:
        FileError: a mission, world or plug-in file cannot be used.
        UsageError: an option does not fit, or the vehicles cannot fly together.
    """
    members = members_of(wanted)
    if wanted.sitl is not None or wanted.vehicles:
        return _over_mavlink(wanted, members)
    from missionkit.cli.fleet_in_simulator import fly_in_simulator, staged  # noqa: PLC0415 heavy

    if wanted.runs is not None:
        from missionkit.cli.fleet_runs import fly_many  # noqa: PLC0415 heavy

        return fly_many(wanted, members)
    stages = staged(members, wanted.seed, anyway=wanted.anyway)
    folder = run_folder(wanted.out, "fleet", f"seed{wanted.seed}")
    return reported(wanted, fly_in_simulator(wanted, members, stages, folder), folder)


def _over_mavlink(wanted: FleetOptions, members: Sequence[Member]) -> ExitCode:
    if wanted.runs is not None:
        raise UsageError("--runs is for the built-in simulator, not for MAVLink")
    from missionkit.cli.fleet_over_mavlink import check, fly_over_mavlink  # noqa: PLC0415 heavy

    check(wanted, members)
    folder = run_folder(wanted.out, "fleet", wanted.sitl or "vehicles")
    return reported(wanted, fly_over_mavlink(wanted, members, folder), folder)


def reported(wanted: FleetOptions, summary: FleetSummary, folder: Path) -> ExitCode:
    """Write and print the summary; return what the command says to the shell.

    Args:
        wanted: says whether JSON is printed.
        summary: of the fleet.
        folder: of its run.
    """
    write_fleet_summary(folder, summary)
    if wanted.as_json:
        print(json.dumps({**summary.model_dump(), "folder": str(folder)}, indent=2))  # noqa: T201
    else:
        for line in (*summary.lines(), str(folder)):
            print(printable(line))  # noqa: T201
    outcomes = {it.outcome for it in summary.vehicles}
    if outcomes & {"crash", "lost"}:
        return ExitCode.VEHICLE_LOST
    safe = outcomes == {"success"} and not summary.conflicts
    return ExitCode.SUCCESS if safe else ExitCode.ENDED_SAFELY
