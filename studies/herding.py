"""P4's herding mission at the kinematic level: `python -m studies.herding`."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from string import Template
from typing import NamedTuple

import numpy as np
from rich.progress import track

from missionkit.planning.herding.dynamic_programme import DynamicProgramme
from missionkit.planning.herding.herd_memory import PARTICLES
from missionkit.planning.herding.nearest_to_goal import NearestToGoal
from missionkit.plugin_protocols import HerdingPolicyProtocol
from studies.herding_figure import draw, draw_run
from studies.herding_kernels import Facts
from studies.herding_run import Run, run
from studies.markdown import table
from studies.parallel import in_parallel
from studies.statistics import wilson

TEMPLATE = Path(__file__).with_name("herding.md")
OFF = 65.0  # deg, at which P4's policy comes to P4's figure
Flown = Mapping[str, Sequence[Run]]
GOAL = 7  # robots home
TRACKER = {"noise": (0.03, 0.05), "latency": 0.2}
NOISE = "with errors of 3 cm and 3 deg, spins noticed after 0.2 s, 2 % of meetings swapped"
FACTS = Facts()
NEAR = FACTS._replace(sight=2.0, **TRACKER)


class Row(NamedTuple):
    """A row of a table: who chooses, in which world."""

    name: str
    policy: HerdingPolicyProtocol
    facts: Facts
    particles: int = PARTICLES


def ours(facts: Facts, turns: str = "front") -> DynamicProgramme:
    """Return our policy, which knows how long the vehicle takes."""
    waits = max(0.0, facts.lead - facts.contact) / 0.33
    return DynamicProgramme(
        turns=turns,
        speed=facts.speed,
        land=facts.cruise / facts.down + waits,
        touch=(facts.cruise - 0.1) / facts.down,
        climb=facts.cruise / facts.up,
        lead=facts.lead,
    )


def _row(name: str, turns: str = "front", facts: Facts = FACTS, **changed: object) -> Row:
    facts = facts._replace(**changed)
    return Row(name, ours(facts, turns), facts)


PAPER = Row("P4's, firmware's clock", NearestToGoal(), FACTS)
CALIBRATED = Row("P4's, calibrated", NearestToGoal(off_deg=OFF), FACTS._replace(resets=True))
FRONT = _row("ours, landing in front, whole arena")
BOTH = _row("ours, front and top, whole arena", "front_and_top")
NEAR_FRONT = _row("ours, landing in front, 2 m sight", facts=NEAR)
NEAR_BOTH = _row("ours, front and top, 2 m sight", "front_and_top", NEAR)
HEADLINE = (PAPER, CALIBRATED, FRONT, NEAR_FRONT, BOTH, NEAR_BOTH)
ABLATION = NEAR_FRONT._replace(name="2 m sight, one hypothesis", particles=1)
SENSITIVITY = (
    _row("as above"),
    _row("down at 0.5 m/s, up at 0.75", down=0.5, up=0.75),
    _row("1.0 m/s", speed=1.0),
    _row("lands 0.40 m ahead", lead=0.40),
    _row("lands 0.70 m ahead", lead=0.70),
    _row("lands 1.0 m ahead", lead=1.0),
    _row("errors of 10 cm, 0.2 rad", noise=(0.10, 0.2), latency=0.2),
    _row("2 m sight, no errors", sight=2.0),
    _row("1.5 m sight, tracker's errors", facts=NEAR, sight=1.5),
    _row("3 m sight, tracker's errors", facts=NEAR, sight=3.0),
)


def share(runs: Sequence[Run], least: int = GOAL) -> str:
    """Return in how many runs at least so many came home, with its interval."""
    hits = sum(it.home >= least for it in runs)
    low, high = wilson(hits, len(runs))
    return f"{100.0 * hits / len(runs):.1f} % [{100.0 * low:.1f}, {100.0 * high:.1f}]"


HEADER = (
    "policy",
    "at least 7 home",
    "ten home",
    "home",
    "removed",
    "remained",
    "bumps, touches",
    "towers hit",
)


def cells(name: str, runs: Sequence[Run]) -> tuple[str, ...]:
    """Return a row of a table."""
    means = np.mean([it[:5] for it in runs], axis=0)
    return (
        name,
        share(runs),
        f"{100.0 * np.mean([it.home == 10 for it in runs]):.1f} %",
        *(f"{value:.2f}" for value in means[:3]),
        f"{means[3]:.0f}, {means[4]:.0f}",
        f"{sum(it.hit for it in runs)} of {len(runs)}",
    )


def flown(rows: Sequence[Row], seeds: range, near: range, workers: int) -> Flown:
    """Return the runs of each row.

    Args:
        rows: what flies.
        seeds: of each row that sees all.
        near: of each row with a limited sight.
        workers: processes.
    """
    found: dict[str, Sequence[Run]] = {}
    for row in rows:
        one = partial(run, policy=row.policy, facts=row.facts, particles=row.particles)
        mine = seeds if math.isinf(row.facts.sight) else near
        done = in_parallel(one, mine, workers, chunk=10)
        quiet = not sys.stderr.isatty()
        found[row.name] = list(track(done, row.name, len(mine), disable=quiet))
        sys.stdout.write(" | ".join(cells(row.name, found[row.name])) + "\n")
        sys.stdout.flush()
    return found


def page(
    headline: Mapping[str, Sequence[Run]],
    more: Mapping[str, Sequence[Run]],
    first: int,
    command: str,
) -> str:
    """Return the page.

    Args:
        headline: runs by row.
        more: those of the sensitivity, the ablation last.
        first: seed.
        command: that produced it.
    """
    *others, ablation = more.items()
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        command=command,
        verdict=verdict(headline),
        headline=table(HEADER, [cells(*it) for it in headline.items()]),
        first=first,
        noise=NOISE,
        off=f"{OFF:g}",
        bumps=f"{np.mean([it.bumps for it in headline[FRONT.name]]):.0f}",
        papers=f"{np.mean([it.bumps for it in headline[PAPER.name]]):.0f}",
        ablation=f"{share(ablation[1])} of {len(ablation[1])} runs bring seven home",
        sensitivity=table(HEADER, [cells(*it) for it in others]),
        few=len(ablation[1]),
        lead=f"{FACTS.lead:g}",
    )


def verdict(headline: Flown) -> str:
    """Return the results in a few lines."""
    lines = (
        ("Landing in front only, whole arena seen", FRONT),
        ("The same with 2 m of sight and a tracker's errors", NEAR_FRONT),
        ("Front and top, whole arena", BOTH),
        ("P4's policy, calibrated (P4: 24.5 %)", CALIBRATED),
    )
    return "\n".join(
        f"- {text}: at least seven home in {share(headline[row.name])}, ten in "
        f"{100.0 * np.mean([it.home == 10 for it in headline[row.name]]):.1f} %."
        for text, row in lines
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Fly all rows and write the page and its pictures."""
    parser = argparse.ArgumentParser(prog="python -m studies.herding", description=main.__doc__)
    parser.add_argument("--seeds", type=int, default=1000)
    parser.add_argument("--near", type=int, default=1000, help="seeds with a limited sight")
    parser.add_argument("--few", type=int, default=300, help="seeds of the sensitivity")
    parser.add_argument("--first", type=int, default=50_000, help="seed")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    chosen = parser.parse_args(arguments)
    seeds = range(chosen.first, chosen.first + chosen.seeds)
    headline = flown(HEADLINE, seeds, seeds[: chosen.near], chosen.workers)
    few = range(chosen.first, chosen.first + chosen.few)
    more = flown((*SENSITIVITY, ABLATION), few, few, chosen.workers)
    words = " ".join(f"--{key} {getattr(chosen, key)}" for key in ("seeds", "near", "few", "first"))
    chosen.out.mkdir(parents=True, exist_ok=True)
    text = page(headline, more, chosen.first, f"python -m studies.herding {words}")
    (chosen.out / "herding.md").write_text(text, encoding="utf-8")
    shown = {row.name: headline[row.name] for row in (CALIBRATED, FRONT, NEAR_FRONT, BOTH)}
    draw(chosen.out / "herding.png", shown)
    draw_run(chosen.out / "herding_run.png", chosen.first, NEAR_BOTH.policy, NEAR_BOTH.facts)


if __name__ == "__main__":
    main()
