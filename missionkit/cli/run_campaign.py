"""`missionkit campaign` and `missionkit report`."""

from __future__ import annotations

import json
import sys
from functools import partial
from pathlib import Path
from typing import NamedTuple

from missionkit.api.campaign import cores, planned, reported, rule_of
from missionkit.api.missions import assemble
from missionkit.campaigns import dask_cluster, process_pool, run_journal
from missionkit.campaigns.analysis import Analysis
from missionkit.campaigns.campaign_loop import Crew, conduct
from missionkit.campaigns.campaign_plan import (
    Campaign,
    digest_of,
    found,
    keep,
)
from missionkit.campaigns.campaign_summary import summed_up
from missionkit.campaigns.chain_file import write_chain
from missionkit.campaigns.number_format import between, percent
from missionkit.campaigns.progress_line import CampaignProgress
from missionkit.campaigns.variants import axes
from missionkit.chart.load import load
from missionkit.cli.overrides import overrides
from missionkit.engine.clock import stopwatch
from missionkit.errors import ExitCode, UsageError
from missionkit.recorder.run_folder import keep_mission, run_folder
from missionkit.version import __version__

RUNS = 100


class CampaignOptions(NamedTuple):
    """The options of the command."""

    mission: Path | None
    runs: int | None
    seed: int
    settings: tuple[str, ...]
    vary: tuple[str, ...]
    faults: tuple[str, ...]
    events: tuple[str, ...]
    plugins: tuple[Path, ...]
    workers: int | None
    cluster: str | None
    timeout: float
    width: float | None
    require: float | None
    better: float | None
    out: Path
    resume: Path | None
    chain: Path | None = None
    records: bool = False
    as_json: bool = False


def campaign(wanted: CampaignOptions) -> ExitCode:
    """Fly, or resume; leave a folder with journal, table, summary and report.

    Raises:
        FileError: mission, world or plug-in file cannot be used.
        UsageError: an option does not fit, or there is nothing to resume.
        VehicleError: the cluster does not answer.
    """
    plan, folder = _begun(wanted) if wanted.resume is None else _resumed(wanted, wanted.resume)
    total, known = plan.runs * plan.variants, run_journal.read(folder)
    progress = CampaignProgress(sys.stderr, stopwatch, known, total)
    try:
        conduct(plan, folder, _crew(plan, folder, wanted), progress)
    except KeyboardInterrupt:
        progress.finish()
        print(f"stopped; resume with: missionkit campaign --resume {folder}", file=sys.stderr)  # noqa: T201
        return ExitCode.ENDED_SAFELY
    progress.finish()
    return report(folder, as_json=wanted.as_json, chain=wanted.chain)


def report(folder: Path, *, as_json: bool, chain: Path | None = None) -> ExitCode:
    """Write table, summary and page from the journal; say in a few lines what they say.

    Args:
        folder: of the campaign.
        as_json: print the summary for programs.
        chain: file for the Markov chain that was flown; None: it is not written.

    Raises:
        UsageError: the folder holds no campaign, or none of its runs has ended; or there is not
            one chain to write.
    """
    results = reported(folder)
    if chain is not None:
        write_chain(chain, results)
    if as_json:
        print(json.dumps({**summed_up(results), "folder": str(folder)}, indent=2))  # noqa: T201
    else:
        print("\n".join([*_lines(results), str(folder / "report.html")]))  # noqa: T201
    return _exit_code(results)


def _begun(wanted: CampaignOptions) -> tuple[Campaign, Path]:
    """Check everything that every variant needs, then make the folder."""
    if wanted.mission is None:
        raise UsageError("name the mission file to fly, or --resume FOLDER")
    if wanted.chain is not None and wanted.vary:
        raise UsageError("--chain writes the chain of one variant; leave out --vary")
    settings = overrides(wanted.settings)
    plan = planned(
        wanted.mission,
        settings,
        axes(wanted.vary, settings),
        plugins=wanted.plugins,
        faults=wanted.faults,
        events=wanted.events,
        seed=wanted.seed,
        runs=wanted.runs or RUNS,
        timeout=wanted.timeout,
        rule=rule_of(width=wanted.width, require=wanted.require, better=wanted.better),
        records=wanted.records,
    )
    folder = run_folder(wanted.out, plan.name, f"campaign-seed{wanted.seed}")
    keep_mission(folder, wanted.mission)
    keep(folder, plan)
    return plan, folder


def _resumed(wanted: CampaignOptions, folder: Path) -> tuple[Campaign, Path]:
    """Return the campaign of a folder; only the number of runs and the workers may change."""
    plan = found(folder)
    if wanted.settings or wanted.vary or wanted.faults or wanted.plugins or wanted.seed:
        raise UsageError(
            "--resume continues the campaign as it was started: leave out --set, --vary, "
            "--fault, --plugin and --seed"
        )
    if plan.missionkit != __version__:
        raise UsageError(
            f"{folder}: started with missionkit {plan.missionkit}, this is {__version__}"
        )
    path, plugins = Path(plan.mission), tuple(map(Path, plan.plugins))
    mission = load(path, assemble(plugins), plan.settings)
    if digest_of(mission, path, plugins) != plan.digest:
        raise UsageError(f"{folder}: the files of the mission have changed since it was started")
    if wanted.runs is not None and wanted.runs != plan.runs:
        plan = plan.model_copy(update={"runs": max(wanted.runs, plan.runs)})
        keep(folder, plan)
    return plan, folder


def _crew(plan: Campaign, folder: Path, wanted: CampaignOptions) -> Crew:
    order = plan.order(folder)
    if wanted.cluster is not None:
        return partial(dask_cluster.flown, order, address=wanted.cluster, timeout=plan.timeout)
    workers = wanted.workers or cores()
    return partial(process_pool.flown, order, workers=workers, timeout=plan.timeout)


def _lines(results: Analysis) -> list[str]:
    lines = []
    for variant in results.variants:
        outcomes = ", ".join(f"{n} {it.replace('_', ' ')}" for it, n in variant.outcomes.items())
        rate = f"{percent(variant.success.value)}, {between(variant.success, percent)}"
        decided = "" if variant.decision is None else f"; required: {variant.decision.verdict}"
        lines.append(f"{variant.name}: success {rate} ({outcomes}){decided}")
    return lines


def _exit_code(results: Analysis) -> ExitCode:
    """Return success, unless something was required that not every variant is shown to have."""
    decisions = [it.decision.verdict for it in results.variants if it.decision is not None]
    met = all(verdict == "met" for verdict in decisions)
    return ExitCode.SUCCESS if met else ExitCode.ENDED_SAFELY
