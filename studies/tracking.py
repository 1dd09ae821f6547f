"""P4's estimation by several models, and the tracker: `python -m studies.tracking`."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from string import Template
from typing import NamedTuple, TypeVar

import numpy as np
from rich.progress import track

from missionkit.estimation.target_tracking.multiple_models import OBSTACLE_SHARE, Estimator
from studies.markdown import table
from studies.statistics import rms, wilson
from studies.tracking_figure import draw
from studies.tracking_flight import Followed, followed
from studies.tracking_runs import (
    MANY,
    SEEN_FOR,
    Identity,
    Single,
    classified,
    crossing,
    singles,
)
from studies.tracking_scene import FOCAL, HEIGHT, ROBOT, Scene

TEMPLATE = Path(__file__).with_name("tracking.md")
SCENES: Mapping[str, Scene] = {
    "two detectors, 90 % each": MANY,
    "one detector, 80 %": Scene(found=0.8, false=0.05),
    "two, vehicle off by 5 cm and 1 deg": MANY._replace(position=0.05, attitude=math.radians(1.0)),
}
PROTOTYPE = ("a prototype, IMM", "0.18 (0.30)", "", "(0.85)", "(2.3)", "(0.92)", "(3.2)", "", "")
OBSTACLE_ROBOT = "obstacle robot"
KINDS = ("target", OBSTACLE_ROBOT)
T = TypeVar("T")
Each = Callable[[Callable[[int], T], Sequence[int]], list[T]]


class Results(NamedTuple):
    """All that the page shows."""

    singles: Sequence[Mapping[Estimator, Single]]
    flights: Sequence[Followed]
    crossings: Mapping[str, Sequence[Identity]]
    classes: Mapping[tuple[str, float], Sequence[float]]  # by what it is, and after how long


def verdict(results: Results) -> str:
    """Return the results in a few lines."""
    imm = _merged(results.singles, "imm")
    kept = [it == "kept" for it in results.crossings[next(iter(SCENES))]]
    last = [_right(*it) for it in results.classes.items() if it[0][1] == SEEN_FOR[-1]]
    wrong = [not p > 0.5 for p in np.concatenate(last).tolist()]
    return "\n".join(
        (
            f"- Spins: {len(imm.delays)} detected by IMM, {imm.missed} missed, 95 % within "
            f"{np.percentile(imm.delays, 95):.2f} s; {_false(imm)} of the other frames called a "
            "spin.",
            f"- IMM: {100.0 * rms(imm.straight[:, 0]):.2f} cm and "
            f"{math.degrees(rms(imm.straight[:, 1])):.1f} deg rms while it drives straight, "
            f"{math.degrees(rms(imm.after[:, 1])):.1f} deg in the 3 s after a spin.",
            f"- Identities kept when two paths come within 0.3 m: {_share(kept)}.",
            f"- Class wrong after 3 s: {_share(wrong)}.",
        )
    )


def page(results: Results, length: float, command: str) -> str:
    """Return the page.

    Args:
        results: of all runs.
        length: s, of the runs of one robot.
        command: that produced it.
    """
    pixels = max(float(np.abs(run.pixels).max()) for run in results.flights)
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        command=command,
        verdict=verdict(results),
        singles=len(results.singles),
        length=f"{length:g}",
        sd=f"{100.0 * 1.5 / FOCAL * HEIGHT:.2f}",
        one=table(ONE, [*(_row(results.singles, name) for name in results.singles[0]), PROTOTYPE]),
        flights=len(results.flights),
        pixels=f"{pixels:.0f} px",
        crossings=len(next(iter(results.crossings.values()))),
        crossing=table(
            ("seen by", "both identities kept", "swapped", "lost"),
            [_identities(*it) for it in results.crossings.items()],
        ),
        **{"class": table(CLASS, _classes(results.classes))},
        share=f"{100.0 * OBSTACLE_SHARE:.0f} %",
        turn=f"{math.degrees(math.degrees(ROBOT.turn_variance)):.1f}",
    )


ONE = (
    *("", "detected after (p95), s", "missed", "straight: mean (rms), cm", "deg"),
    *("3 s after a spin: cm", "deg", "heading 0.5, 1, 3 s after", "false spin"),
)
CLASS = ("robot", "seen for", "runs", "wrong", "less than 99 % sure")


def _row(runs: Sequence[Mapping[Estimator, Single]], name: Estimator) -> tuple[str, ...]:
    it = _merged(runs, name)
    if name == "static":
        cells = _mean(100.0 * it.straight[:, 0]), "", _mean(100.0 * it.after[:, 0])
        return "`static`", "", "", *cells, "", "", ""
    p50, p95 = np.percentile(it.delays, (50, 95))
    headings = np.degrees(np.median(it.wrong_at, axis=0))
    return (
        f"`{name}`",
        f"{p50:.2f} ({p95:.2f})",
        f"{it.missed} of {it.missed + len(it.delays)}",
        _mean(100.0 * it.straight[:, 0]),
        _mean(np.degrees(it.straight[:, 1])),
        _mean(100.0 * it.after[:, 0]),
        _mean(np.degrees(it.after[:, 1])),
        ", ".join(f"{value:.0f}" for value in headings) + " deg",
        _false(it),
    )


def _merged(runs: Sequence[Mapping[Estimator, Single]], name: Estimator) -> Single:
    mine = [run[name] for run in runs]
    return Single(
        tuple(delay for run in mine for delay in run.delays),
        sum(run.missed for run in mine),
        np.concatenate([run.straight for run in mine]),
        np.concatenate([run.after for run in mine]),
        np.concatenate([run.wrong_at for run in mine]),
        (sum(run.false[0] for run in mine), sum(run.false[1] for run in mine)),
    )


def _identities(scene: str, found: Sequence[Identity]) -> tuple[str, ...]:
    swapped, lost = found.count("swapped"), found.count("lost")
    return scene, _share(it == "kept" for it in found), str(swapped), str(lost)


def _classes(classes: Mapping[tuple[str, float], Sequence[float]]) -> Iterator[tuple[str, ...]]:
    for (what, seconds), values in classes.items():
        right = _right((what, seconds), values)
        yield (
            what,
            f"{seconds:g} s",
            str(len(values)),
            _share([not p > 0.5 for p in right]),
            _share([not p > 0.99 for p in right]),
        )


def _right(key: tuple[str, float], values: Sequence[float]) -> list[float]:
    """Return the probability of what it is; NaN, which counts as wrong: not tracked."""
    return [p if key[0] == OBSTACLE_ROBOT else 1.0 - p for p in values]


def _mean(errors: np.ndarray) -> str:
    return f"{errors.mean():.2f} ({rms(errors):.2f})"


def _false(it: Single) -> str:
    return f"{100.0 * it.false[0] / it.false[1]:.3f} %"


def _share(answers: Iterable[bool]) -> str:
    """Return how often something holds, with its 95 % interval."""
    held = list(answers)
    low, high = wilson(sum(held), len(held))
    return f"{sum(held)} of {len(held)} ({100.0 * low:.1f} to {100.0 * high:.1f} %)"


def results_of(seeds: int, flights: int, length: float, first: int, each: Each) -> Results:
    """Return the results of all runs.

    Args:
        seeds: of every table.
        flights: as P4's Fig. 5.
        length: s, of the runs of one robot.
        first: seed.
        each: maps a function over seeds.
    """
    chosen = range(first, first + seeds)
    more = range(first, first + 5 * seeds // 2)  # half of the robots leave the view
    classes = {}
    for what in KINDS:
        answers = each(partial(classified, obstacle=what == OBSTACLE_ROBOT), more)
        stayed = [it for it in answers if it is not None]
        classes |= {(what, at): [it[k] for it in stayed] for k, at in enumerate(SEEN_FOR)}
    return Results(
        each(partial(singles, length=length), chosen),
        each(partial(followed, "imm"), range(first, first + flights)),
        {name: each(partial(crossing, scene=scene), chosen) for name, scene in SCENES.items()},
        classes,
    )


def main(arguments: Sequence[str] | None = None) -> None:
    """Track robots over many seeds and write up how well."""
    parser = argparse.ArgumentParser(prog="python -m studies.tracking", description=main.__doc__)
    parser.add_argument("--seeds", type=int, default=200)
    parser.add_argument("--flights", type=int, default=50, help="as P4's Fig. 5")
    parser.add_argument("--length", type=float, default=45.0, help="s, of the runs of one robot")
    parser.add_argument("--first", type=int, default=0, help="seed")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    chosen = parser.parse_args(arguments)
    with ProcessPoolExecutor(chosen.workers, mp_context=get_context("spawn")) as pool:

        def each(run: Callable[[int], T], seeds: Sequence[int]) -> list[T]:
            done = pool.map(run, seeds, chunksize=4)
            return list(track(done, "tracking", len(seeds), disable=not sys.stderr.isatty()))

        results = results_of(chosen.seeds, chosen.flights, chosen.length, chosen.first, each)
    words = (f"--{key} {getattr(chosen, key):g}" for key in ("seeds", "flights", "length", "first"))
    write(results, chosen.length, chosen.out, f"python -m studies.tracking {' '.join(words)}")
    print(verdict(results))  # noqa: T201


def write(results: Results, length: float, out: Path, command: str) -> None:
    """Write the page and its picture.

    Args:
        results: of all runs.
        length: s, of the runs of one robot.
        out: folder.
        command: that produced it.
    """
    out.mkdir(parents=True, exist_ok=True)
    (out / "tracking.md").write_text(page(results, length, command), encoding="utf-8")
    runs: dict[Estimator, Followed] = {"mmae": followed("mmae", 0), "imm": results.flights[0]}
    imm = _merged(results.singles, "imm")
    subtitle = (
        f"{len(results.singles)} other robots by IMM: spin detected within "
        f"{np.percentile(imm.delays, 95):.2f} s (p95), "
        f"heading {math.degrees(rms(imm.straight[:, 1])):.1f} deg rms"
    )
    draw(out / "tracking.png", runs, subtitle)


if __name__ == "__main__":
    main()
