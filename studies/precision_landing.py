"""P3's precision landing against fixed switches: `python -m studies.precision_landing`."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator, Sequence
from functools import cache
from pathlib import Path
from string import Template

import numpy as np
from rich.progress import track

from missionkit.campaigns.statistics import ConfidenceInterval, bootstrap, quantile
from missionkit.planning.energy_optimal import Airframe, plan
from missionkit.planning.landing_profiles import LandingLimits
from missionkit.planning.rotor_power import RotorPower
from missionkit.rehearsal.stage import world_of
from studies.assumptions import assumptions
from studies.markdown import table
from studies.precision_landing_figure import draw
from studies.precision_landing_flight import (
    CASES,
    MISSION,
    POOR_CASES,
    RULES,
    UNGUARDED,
    Landing,
    Order,
    fly_all,
    mission_of,
)
from studies.statistics import wilson

TEMPLATE = Path(__file__).with_name("precision_landing.md")
WINDS = (0.0, 3.0)  # m/s, mean
SEED = 3  # of the resampling
GOALS = {"conservative": (-40.0, "at least 40 % less"), "brisk": (-20.0, "at least 20 % less")}
ABOVE_BLIND = 5.0  # %, at most


def orders(seeds: Sequence[int], camera: str) -> list[Order]:
    """Return the flights: every rule, case and wind on the same seeds."""
    return [
        Order(rule, case, wind, seed, camera)
        for seed in seeds
        for rule in RULES
        for case in CASES
        for wind in WINDS
    ]


def poor_orders(seeds: Sequence[int], camera: str) -> list[Order]:
    """Return the flights with a poor estimate: with the rule to deviate and without it.

    Args:
        seeds: of the flights.
        camera: `rendered` or `corners`.
    """
    return [
        Order(rule, case, WINDS[-1], seed, camera, poor=True)
        for seed in seeds
        for case in POOR_CASES
        for rule in ("ours", UNGUARDED)
    ]


def chosen(
    runs: Sequence[Landing],
    rule: str,
    case: tuple[float, float] | None = None,
    wind: float | None = None,
) -> list[Landing]:
    """Return the flights of a rule, by seed, case and wind."""
    mine = [run for run in runs if run.order.rule == rule]
    mine = [run for run in mine if case is None or run.order.case == case]
    return [run for run in mine if wind is None or run.order.wind == wind]


def gain(first: Sequence[Landing], second: Sequence[Landing]) -> ConfidenceInterval:
    """Return by how much (%) the second flights take more energy than the first, pair by pair.

    The mean of both on the same seeds, with a paired bootstrap interval.
    """
    pairs = [(a.energy, b.energy) for a, b in zip(first, second, strict=True)]
    energies = np.array(pairs).T
    rows = np.arange(len(pairs), dtype=float)

    def ratio(drawn: np.ndarray) -> np.ndarray:
        picked = np.asarray(drawn, dtype=int)
        means = energies[:, picked].mean(axis=-1)
        return np.asarray(100.0 * (means[1] / means[0] - 1.0))

    return bootstrap(list(rows), ratio, np.random.default_rng(SEED))


def p95(runs: Sequence[Landing]) -> ConfidenceInterval:
    """Return the 95th percentile of the touch-down error (cm)."""
    return quantile([100.0 * run.missed for run in runs], 0.95, np.random.default_rng(SEED))


@cache
def planned(case: tuple[float, float]) -> tuple[float, float]:
    """Return energy (J) and time (s) of the planned path, in still air and without any lag.

    Args:
        case: level distance and height (m) at the start.
    """
    path = plan(*case, Airframe(1.2, 0.0118, RotorPower().model()), LandingLimits(speed=5.4))
    return path.energy, float(path.times[-1])


def above_plan(runs: Sequence[Landing], rule: str) -> float:
    """Return by how much (%) the flights of a rule in calm air take more energy than the plan.

    Args:
        runs: of the study.
        rule: one of `RULES`.
    """
    flown = [np.mean([run.energy for run in chosen(runs, rule, case, 0.0)]) for case in CASES]
    return float(100.0 * (sum(flown) / sum(planned(case)[0] for case in CASES) - 1.0))


def verdict(runs: Sequence[Landing]) -> str:
    """Return how the goals were met, over all cases and winds, in a few lines."""
    ours = chosen(runs, "ours")
    lines = []
    for rule, (most, wanted) in GOALS.items():
        found = gain(chosen(runs, rule), ours)
        met = "met" if found.high <= most else "missed"
        lines.append(f"- Energy against {rule}: {_percent(found)}; wanted {wanted}: {met}.")
    found = gain(chosen(runs, "blind"), ours)
    met = "met" if found.high <= ABOVE_BLIND else "missed"
    lines.append(
        f"- Energy against blind, flown by the same law: {_percent(found)}; wanted at most "
        f"{ABOVE_BLIND:g} % more: {met}. Against the plan, which knows no lag, in calm air: ours "
        f"{above_plan(runs, 'ours'):+.0f} %, blind {above_plan(runs, 'blind'):+.0f} %."
    )
    errors = ", ".join(f"{rule} {_said(p95(chosen(runs, rule)), 1)}" for rule in RULES)
    slow = min(p95(chosen(runs, rule)).value for rule in GOALS)
    met = "met" if p95(ours).value <= slow else "missed"
    lines.append(
        f"- 95th percentile of the touch-down error, cm: {errors}; wanted no worse than "
        f"conservative and brisk: {met}."
    )
    seen = sum(run.seen for run in ours)
    low, high = wilson(seen, len(ours))
    good = sum(run.succeeded for run in ours)
    lines.append(
        f"- Pad seen in {seen} of {len(ours)} flights ({100 * low:.1f} to {100 * high:.1f} %); "
        f"{good} succeeded."
    )
    return "\n".join(lines)


def guarded(runs: Sequence[Landing]) -> Iterator[tuple[str, ...]]:
    """Yield a row for each rule: flights with a poor estimate, and how they went.

    Args:
        runs: those flights.
    """
    for rule in ("ours", UNGUARDED):
        mine = chosen(runs, rule)
        good = [run for run in mine if run.succeeded]
        low, high = wilson(len(good), len(mine))
        yield (
            rule,
            str(len(mine)),
            str(sum("deviate" in run.states for run in mine)),
            f"{len(good)} ({100 * low:.0f} to {100 * high:.0f} %)",
            f"{np.mean([run.duration for run in mine]):.1f}",
            f"{np.mean([run.energy for run in mine]):.0f}",
            f"{100 * np.quantile([run.missed for run in good], 0.95):.1f}" if good else "—",
        )


def page(runs: Sequence[Landing], poor: Sequence[Landing], command: str) -> str:
    """Return the page."""
    mission = mission_of("ours", CASES[0])
    world = world_of(mission, MISSION.parent)
    heads = ("case", "wind, m/s", "ours, J", *(f"against {rule}" for rule in (*GOALS, "blind")))
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        command=command,
        verdict=verdict(runs),
        number=len(runs),
        glided=len(chosen(runs, "ours")),
        deviated=sum("deviate" in run.states for run in chosen(runs, "ours")),
        energies=table(heads, _energies(runs)),
        errors=table(("case", "wind, m/s", *RULES), _errors(runs)),
        flights=table(
            ("rule", "flights", "succeeded", "pad seen", "time, s", "touch, m/s, median, most"),
            _flights(runs),
        ),
        pairs=len(poor) // 2,
        guarded=table(
            ("rule", "flights", "deviated", "succeeded", "time, s", "energy, J", "p95, cm"),
            guarded(poor),
        ),
        planned=table(
            ("case", "planned, J", "blind, J", "ours, J", "time of each, s"), _planned(runs)
        ),
        assumptions="\n".join(f"- {name}: {text}" for name, text in assumptions(mission, world)),
    )


def _energies(runs: Sequence[Landing]) -> Iterator[tuple[str, ...]]:
    for case in CASES:
        for wind in WINDS:
            ours = chosen(runs, "ours", case, wind)
            found = [gain(chosen(runs, rule, case, wind), ours) for rule in (*GOALS, "blind")]
            mean = f"{np.mean([run.energy for run in ours]):.0f}"
            yield _named(case), f"{wind:g}", mean, *map(_percent, found)


def _errors(runs: Sequence[Landing]) -> Iterator[tuple[str, ...]]:
    for case in CASES:
        for wind in WINDS:
            found = [p95(chosen(runs, rule, case, wind)) for rule in RULES]
            yield _named(case), f"{wind:g}", *(_said(it, 1) for it in found)


def _flights(runs: Sequence[Landing]) -> Iterator[tuple[str, ...]]:
    for rule in RULES:
        mine = chosen(runs, rule)
        touched = [run.touched for run in mine]
        yield (
            rule,
            str(len(mine)),
            str(sum(run.succeeded for run in mine)),
            str(sum(run.seen for run in mine)),
            f"{np.mean([run.duration for run in mine]):.1f}",
            f"{np.median(touched):.2f}, {max(touched):.2f}",
        )


def _planned(runs: Sequence[Landing]) -> Iterator[tuple[str, ...]]:
    for case in CASES:
        energy, time = planned(case)
        flown = [chosen(runs, rule, case, 0.0) for rule in ("blind", "ours")]
        yield (
            _named(case),
            f"{energy:.0f}",
            *(f"{np.mean([run.energy for run in mine]):.0f}" for mine in flown),
            ", ".join(
                f"{it:.1f}"
                for it in (time, *(np.mean([run.duration for run in mine]) for mine in flown))
            ),
        )


def _named(case: tuple[float, float]) -> str:
    return f"{case[0]:g} m, {case[1]:g} m up"


def _percent(found: ConfidenceInterval) -> str:
    return f"{found.value:+.1f} % [{found.low:+.1f}, {found.high:+.1f}]"


def _said(found: ConfidenceInterval, digits: int) -> str:
    low, high = f"{found.low:.{digits}f}", f"{found.high:.{digits}f}"
    return "—" if math.isnan(found.value) else f"{found.value:.{digits}f} [{low}, {high}]"


def write(runs: Sequence[Landing], poor: Sequence[Landing], out: Path, command: str) -> None:
    """Write the page and its picture into the folder `out`."""
    out.mkdir(parents=True, exist_ok=True)
    seeds = len({run.order.seed for run in runs})
    subtitle = f"{len(runs)} flights, {seeds} seeds, the same for every rule"
    draw(out / "precision_landing.png", runs, subtitle)
    (out / "precision_landing.md").write_text(page(runs, poor, command), encoding="utf-8")


def main(arguments: Sequence[str] | None = None) -> None:
    """Land by every rule, in every case and wind, over many seeds, and write up the results."""
    parser = argparse.ArgumentParser(
        prog="python -m studies.precision_landing", description=main.__doc__
    )
    parser.add_argument("--seeds", type=int, default=10, help="of each rule, case and wind")
    parser.add_argument("--poor", type=int, default=20, metavar="SEEDS", help="of a poor estimate")
    parser.add_argument("--first", type=int, default=3000, metavar="SEED")
    parser.add_argument("--camera", choices=("rendered", "corners"), default="rendered")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    given = parser.parse_args(arguments)
    wanted = orders(range(given.first, given.first + given.seeds), given.camera)
    wanted += poor_orders(range(given.first, given.first + given.poor), given.camera)
    flights = fly_all(wanted, given.workers)
    done = list(track(flights, "flying", len(wanted), disable=not sys.stderr.isatty()))
    runs = [run for run in done if not run.order.poor]
    poor = [run for run in done if run.order.poor]
    command = (
        f"python -m studies.precision_landing --seeds {given.seeds} --poor {given.poor} "
        f"--first {given.first} --camera {given.camera}"
    )
    write(runs, poor, given.out, command)
    print(verdict(runs))  # noqa: T201


if __name__ == "__main__":
    main()
