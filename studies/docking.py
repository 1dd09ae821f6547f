"""P3's docking by fixed distances, by Algorithm 1 and by ours: `python -m studies.docking`."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from string import Template

from rich.progress import track

from missionkit.rehearsal.stage import world_of
from missionkit.sim.free_flyer.world import FreeFlyerWorld
from studies.assumptions import numbers
from studies.docking_figure import NAMES, draw_distances, draw_paths
from studies.docking_flight import (
    MISSION,
    RULES,
    VARIANTS,
    Docking,
    Order,
    fly_all,
    mission_of,
)
from studies.docking_results import chosen, gain, mean, pairs, percent, share
from studies.markdown import table
from studies.statistics import wilson

TEMPLATE = Path(__file__).with_name("docking.md")
REPORTED = {
    "fixed": (140.05, 10.7858, 0.567, 0.0137),
    "markov_printed": (126.65, 9.2679, 0.568, 0.0129),
}
"""P3, Table II: s, N·s, cm, rad."""
ROWS = ("as shipped", "gains", "speed", "slew", "outliers", "far side", "anywhere")
STOPS = {"stop 3 mm": 3, "paper": 6, "stop 10 mm": 10}  # mm
ALONE = {
    "at its r1": "fixed",
    "stop 3 mm": "fixed",
    "stop 10 mm": "fixed",
    "solid": "markov_printed",
}
MEASURES = ("time", "impulse", "position_error", "attitude_error")


def orders(first: int, many: int, fewer: int) -> list[Order]:
    """Return the flights: of each rule `many`, of each variant `fewer`, on the same seeds."""
    found = []
    for seed in range(first, first + many):
        found += [Order(rule, "paper", seed) for rule in RULES]
        if seed < first + fewer:
            for variant in ROWS:
                found += [Order("fixed", variant, seed), Order("ours", variant, seed)]
            found += [Order(rule, variant, seed) for variant, rule in ALONE.items()]
    return found


def verdict(runs: Sequence[Docking]) -> str:
    """Return the results in a few lines."""
    fixed, ours = chosen(runs, "fixed"), chosen(runs, "ours")
    lines = []
    for name, measure, digits, scale in (
        ("time, s", "time", 1, 1.0),
        ("impulse, Ns", "impulse", 2, 1.0),
        ("position error, cm", "position_error", 3, 100.0),
    ):
        value, paper = scale * mean(fixed, measure), REPORTED["fixed"][MEASURES.index(measure)]
        lines.append(
            f"- Fixed distances, {name}: {value:.{digits}f}; P3 {paper:g} "
            f"({100.0 * (value / paper - 1.0):+.1f} %)."
        )
    for rule in RULES[1:]:
        time, impulse = (gain(fixed, chosen(runs, rule), it) for it in ("time", "impulse"))
        lines.append(
            f"- {NAMES[rule]} against fixed: time {percent(time)}, impulse {percent(impulse)}."
        )
    good, least = sum(run.docked for run in ours), min(run.centres for run in ours)
    low, _ = wilson(good, len(ours))
    lines.append(
        f"- Ours docked in {good} of {len(ours)} flights (at least {100.0 * low:.1f} % with 97.5 % "
        f"confidence), and stayed {least:.3f} m or more from centre to centre outside the corridor."
    )
    return "\n".join(f"{line[:2]}{line[2].upper()}{line[3:]}" for line in lines)


def page(runs: Sequence[Docking], command: str) -> str:
    """Return the page."""
    world = world_for("paper")
    printed = chosen(runs, "markov_printed")
    heads = ("rule", "flights", "time, s", "impulse, Ns", "position, cm", "attitude, rad")
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        command=command,
        verdict=verdict(runs),
        number=len(runs),
        each=len(chosen(runs, "ours")),
        touching=f"{world.touching:.3f}",
        corridor=(
            f"{100 * world.corridor.radius:g} cm at the docked place, half-angle "
            f"{world.corridor.half_angle_deg:g}°, {100 * world.corridor.length:g} cm long"
        ),
        headline=table((*heads, "least distance, m", "sideways, cm", "docked"), _headline(runs)),
        differences=table(
            ("rule", "pairs", "time", "impulse", "position error", "attitude error"),
            _differences(runs),
        ),
        r1=f"{mean(printed, 'aligned'):.3f}",
        r2=f"{mean(printed, 'turned'):.3f}",
        least=f"{min((run.centres for run in printed), default=math.nan):.3f}",
        ablation=table(
            ("flights", "pairs", "time", "impulse", "least distance, m"), _ablation(runs)
        ),
        solid=_solid(runs),
        rows=table(
            (
                *("what changes", "pairs", "time", "impulse", "position error"),
                *("docked, ours", "docked, fixed", "least distance, m: ours, fixed"),
            ),
            _rows(runs),
        ),
        stops=table(
            ("stops at, mm", "flights", "time, s", "position, cm", "attitude, rad"), _stops(runs)
        ),
        assumptions="\n".join(f"- {name}: {text}" for name, text in _assumptions(world)),
    )


def world_for(variant: str) -> FreeFlyerWorld:
    """Return the world of a variant."""
    world = world_of(mission_of("fixed", variant), MISSION.parent)
    assert isinstance(world, FreeFlyerWorld)  # noqa: S101 - the mission is that of a free flyer
    return world


def _headline(runs: Sequence[Docking]) -> Iterator[tuple[str, ...]]:
    for rule in RULES:
        if rule in REPORTED:
            time, impulse, place, turn = REPORTED[rule]
            values = (f"{time:.2f}", f"{impulse:.2f}", f"{place:.3f}", f"{turn:.4f}")
            yield f"{NAMES[rule]}, P3", "500", *values, "—", "—", "—"
        mine = chosen(runs, rule)
        yield (
            NAMES[rule],
            str(len(mine)),
            f"{mean(mine, 'time'):.2f}",
            f"{mean(mine, 'impulse'):.2f}",
            f"{100.0 * mean(mine, 'position_error'):.3f}",
            f"{mean(mine, 'attitude_error'):.4f}",
            f"{min(run.centres for run in mine):.3f}",
            f"{100.0 * max(run.sideways for run in mine):.1f}",
            share(mine),
        )


def _differences(runs: Sequence[Docking]) -> Iterator[tuple[str, ...]]:
    fixed = chosen(runs, "fixed")
    for rule in RULES[1:]:
        mine = chosen(runs, rule)
        found = [gain(fixed, mine, measure) for measure in MEASURES]
        yield NAMES[rule], str(len(pairs(fixed, mine, "time"))), *map(percent, found)


def _ablation(runs: Sequence[Docking]) -> Iterator[tuple[str, ...]]:
    fixed, same = chosen(runs, "fixed"), chosen(runs, "fixed", "at its r1")
    seeds = {run.order.seed for run in same}
    printed = [run for run in chosen(runs, "markov_printed") if run.order.seed in seeds]
    for name, mine in (("Algorithm 1 as printed", printed), ("fixed, r1 = 0.12 m", same)):
        if mine:
            found = [gain(fixed, mine, measure) for measure in ("time", "impulse")]
            least = min(run.centres for run in mine)
            yield name, str(len(mine)), *map(percent, found), f"{least:.3f}"


def _solid(runs: Sequence[Docking]) -> str:
    mine = chosen(runs, "markov_printed", "solid")
    crashed = sum(run.crashed for run in mine)
    return f"{crashed} of {len(mine)}"


def _rows(runs: Sequence[Docking]) -> Iterator[tuple[str, ...]]:
    for variant in ("paper", *ROWS):
        fixed, ours = chosen(runs, "fixed", variant), chosen(runs, "ours", variant)
        if not (fixed and ours):
            continue
        found = [gain(fixed, ours, measure) for measure in MEASURES[:3]]
        least = [min(run.centres for run in mine) for mine in (ours, fixed)]
        yield (
            VARIANTS[variant].says,
            str(len(pairs(fixed, ours, "time"))),
            *map(percent, found),
            share(ours),
            share(fixed),
            f"{least[0]:.3f}, {least[1]:.3f}",
        )


def _stops(runs: Sequence[Docking]) -> Iterator[tuple[str, ...]]:
    for variant, stop in STOPS.items():
        mine = chosen(runs, "fixed", variant)
        if mine:
            yield (
                f"{stop}",
                str(len(mine)),
                f"{mean(mine, 'time'):.2f}",
                f"{100.0 * mean(mine, 'position_error'):.3f}",
                f"{mean(mine, 'attitude_error'):.4f}",
            )


def _assumptions(world: FreeFlyerWorld) -> Iterator[tuple[str, str]]:
    mission = mission_of("fixed", "paper")
    yield "body and thrusters", numbers(world.vehicle)
    yield "start", numbers(world.start)
    for name, sensor in world.sensors:
        yield name, numbers(sensor)
    yield "capture", numbers(world.capture)
    yield "navigation", numbers(mission.navigation.plugin)
    yield "control", numbers(mission.control.plugin)
    for name, state, _ in mission.walk():
        if state.behavior is not None and (text := numbers(state.behavior.plugin)):
            yield f"state {name}", text


def write(runs: Sequence[Docking], out: Path, command: str) -> None:
    """Write the page and its pictures into the folder `out`."""
    out.mkdir(parents=True, exist_ok=True)
    world, headline = world_for("paper"), [run for run in runs if run.order.variant == "paper"]
    headline.sort(key=lambda run: run.order.seed)
    draw_paths(out / "docking_paths.png", headline, world)
    draw_distances(out / "docking_distances.png", headline, world.touching)
    (out / "docking.md").write_text(page(runs, command), encoding="utf-8")


def kept(file: Path | None) -> list[Docking]:
    """Return the flights that an earlier run of the study kept."""
    if file is None or not file.exists():
        return []
    return [Docking.of_json(line) for line in file.read_text(encoding="utf-8").splitlines()]


def fly_missing(wanted: Sequence[Order], keep: Path | None, workers: int) -> list[Docking]:
    """Return a flight for each order; those that `keep` has are not flown again."""
    done = {run.order: run for run in kept(keep)}
    missing = [order for order in wanted if order not in done]
    flights = fly_all(missing, workers)
    for run in track(flights, "flying", len(missing), disable=not sys.stderr.isatty()):
        done[run.order] = run
        if keep is not None:
            with keep.open("a", encoding="utf-8") as file:
                file.write(run.as_json() + "\n")
    return [done[order] for order in wanted]


def main(arguments: Sequence[str] | None = None) -> None:
    """Dock by every rule over many seeds, and in other conditions, and write up the results."""
    parser = argparse.ArgumentParser(prog="python -m studies.docking", description=main.__doc__)
    parser.add_argument("--runs", type=int, default=500, help="of each rule")
    parser.add_argument("--rows", type=int, default=40, help="of each other condition")
    parser.add_argument("--first", type=int, default=1000, metavar="SEED")
    parser.add_argument(
        "--keep", type=Path, help="file of flights: those in it are not flown again"
    )
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    given = parser.parse_args(arguments)
    wanted = orders(given.first, given.runs, given.rows)
    runs = fly_missing(wanted, given.keep, given.workers)
    command = (
        f"python -m studies.docking --runs {given.runs} --rows {given.rows} --first {given.first}"
    )
    write(runs, given.out, command)
    print(verdict(runs))  # noqa: T201


if __name__ == "__main__":
    main()
