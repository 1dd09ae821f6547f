"""`missionkit export`: a mission as a file of another program."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from missionkit.api.missions import assemble
from missionkit.chart.load import load
from missionkit.cli.interchange_output import home_of, ledger_path, require_new, tell, write
from missionkit.cli.overrides import overrides
from missionkit.cli.tube_command import export_tube
from missionkit.errors import ExitCode, UsageError
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.mission_plan import mission_plan
from missionkit.interchange.plan_formats import writer_of


def export(
    path: Path,
    out: Path,
    home: str | None,
    settings: Iterable[str],
    plugins: Iterable[Path],
    *,
    force: bool,
) -> ExitCode:
    """Write a mission along the way that `done` leads, and print the ledger.

    What a plan cannot say, such as failsafes, is not a mistake: the exit code is that of success.

    Args:
        path: of the mission file, or the folder of a campaign.
        out: file to write; how its name ends says the format.
        home: LAT,LON,ALT of a mission without an origin.
        settings: NAME=VALUE, as of `--set`.
        plugins: files with plug-ins.
        force: replace a file that exists.

    Raises:
        FileError: the mission cannot be loaded.
        UsageError: it has no place on the earth, or the file cannot be written.
    """
    if path.is_dir():
        return export_tube(path, out, home, force=force)
    kind, writer = writer_of(out)
    require_new(out, force=force)
    mission = load(path, assemble(plugins), overrides(settings))
    ledger = Ledger(path.name, f"mission to {kind}")
    plan = mission_plan(mission, home_of(home), ledger)
    if not plan.actions and plan.fence is None:
        tell(ledger)
        raise UsageError(f"{path}: nothing of it can be written as a {kind}")
    write(out, writer(plan, mission.name, ledger), force=force)
    write(ledger_path(out), ledger.as_json().encode(), force=True)
    tell(ledger)
    return ExitCode.SUCCESS
