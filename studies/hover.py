"""Table I of P2: position spread after a five-minute hover: `python -m studies.hover`."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from string import Template

import numpy as np
from rich.progress import track
from scipy.stats import chi2

from missionkit.estimation.optical_flow.axis_filter import run
from missionkit.geometry import Mat
from missionkit.sim.vehicle_parameters import Sensors
from missionkit.sim.world import World
from studies.assumptions import numbers
from studies.hover_figure import draw
from studies.hover_flight import (
    ALONE,
    BIASED,
    CAMERA,
    ESTIMATING,
    EVERY,
    METHODS,
    P2,
    PERIOD,
    REST,
    SEEING,
    WHOLE,
    Hover,
    hover_all,
    hover_by_sight,
)
from studies.markdown import table

TEMPLATE = Path(__file__).with_name("hover.md")
PAPER = (0.5301, 0.7436)
"""Table I of P2, m: x and y."""
SVO = (0.1300, 0.1436)
"""The same of its visual odometry, m."""
WHITE = 1000
"""Runs of the filter on white noise alone."""


def spread(ends: Mat) -> tuple[float, float, float]:
    """Return the standard deviation of (n,) normal values and its 95 % interval.

    s sqrt((n - 1) / χ²) at both ends of χ² with n - 1 degrees of freedom.
    """
    n, s = len(ends), float(ends.std(ddof=1))
    low, high = (s * math.sqrt((n - 1) / chi2.ppf(p, n - 1)) for p in (0.975, 0.025))
    return s, float(low), float(high)


def ratio(better: Mat, worse: Mat, draws: int = 2000) -> tuple[float, float, float]:
    """Return how many times larger the spread of `worse` (n,) is, with a 95 % bootstrap interval.

    The two belong together flight by flight, so that both are drawn by the same flights.
    """
    picks = np.random.default_rng(0).integers(len(better), size=(draws, len(better)))
    many = worse[picks].std(axis=1) / better[picks].std(axis=1)
    low, high = np.percentile(many, (2.5, 97.5)).tolist()
    return float(worse.std() / better.std()), low, high


def white(axis: int, period: float, length: float) -> float:
    """Return the spread (m) of P2's filter on nothing but white noise, at rest."""
    rng = np.random.default_rng(axis)
    variance, noise = ESTIMATING.accel_variance[axis], ESTIMATING.flow_variance[axis]
    steps = round(length / period)
    ends = []
    for _ in range(WHITE):
        us = math.sqrt(variance) * rng.standard_normal(steps)
        zs = math.sqrt(noise) * rng.standard_normal(steps)
        out = run(np.zeros(2), np.zeros((2, 2)), us, zs, period, variance, noise)
        ends.append(float(out[-1, 0]))
    return float(np.std(ends))


def floor(length: float) -> Mat:
    """Return sqrt(R dt t) (samples, 2), m: white flow noise summed up."""
    times = np.arange(0.0, length + 0.5 * PERIOD, EVERY * PERIOD)
    rates = np.array(ESTIMATING.flow_variance) * PERIOD
    lowest: Mat = np.sqrt(np.outer(times, rates))
    return lowest


def verdict(hovers: Sequence[Hover], sights: Sequence[Hover]) -> str:
    """Return the results in a few lines."""
    ends = _ends(hovers)
    said = {m: _pair(ends[:, m].std(axis=0, ddof=1)) for m in (P2, BIASED, WHOLE, ALONE)}
    seen = _ends(sights)[:, 0].std(axis=0, ddof=1)
    worse = " and ".join(_ratio(*ratio(ends[:, P2, a], ends[:, ALONE, a])) for a in (0, 1))
    return "\n".join(
        (
            f"- P2's filter: {said[P2]} (the paper's: {_pair(PAPER)}).",
            f"- Flow alone: {said[ALONE]}, {worse} times as much.",
            f"- Gyroscope's bias estimated in flight: {said[BIASED]}.",
            f"- The house's EKF with flow: {said[WHOLE]}.",
            f"- Features of the ground, `ud_vision_ekf`: {_fine(seen)} in {len(sights)} flights "
            f"(P2's visual odometry: {_fine(SVO)}).",
        )
    )


def page(hovers: Sequence[Hover], sights: Sequence[Hover], length: float, command: str) -> str:
    """Return the page."""
    wander = np.array([it.wander[BIASED] for it in hovers]).mean(axis=0)
    lowest = _pair(floor(length)[-1])
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        command=command,
        paper=_pair(PAPER),
        flights=len(hovers),
        length=f"{length:g}",
        verdict=verdict(hovers, sights),
        spreads=table(
            ("position by", "x (north)", "y (east)", "one flight: x", "one flight: y"),
            (*_spreads(hovers), *_sight_spreads(sights)),
        ),
        moved=f"{wander[0]:.2f}",
        moved_east=f"{wander[1]:.2f}",
        floor=lowest,
        whites=WHITE,
        white=_pair([white(axis, PERIOD, length) for axis in (0, 1)]),
        white10=_pair([white(axis, 2.0 * PERIOD, length) for axis in (0, 1)]),
        others=table(
            (
                *("by", "velocity error x, rms", "y, rms", "mean error x", "mean error y"),
                *("`position_sd` at the end", "inside"),
            ),
            (*_others(hovers, METHODS), *_others(sights, (_by_sight(sights),))),
        ),
        last=len(hovers) - 1,
        rest=f"{REST:g}",
        align=f"{ESTIMATING.align_for:g}",
        assumptions="\n".join(f"- {name}: {text}." for name, text in _assumed()),
    )


def _spreads(hovers: Sequence[Hover]) -> Iterator[tuple[str, ...]]:
    ends, wander = _ends(hovers), np.array([it.wander for it in hovers]).mean(axis=0)
    yield "P2, Table I", *(f"{value:.2f}" for value in PAPER), "", ""
    for m, name in enumerate(METHODS):
        cells = ("{:.2f} ({:.2f} to {:.2f})".format(*spread(ends[:, m, a])) for a in (0, 1))
        yield name, *cells, *(f"{value:.2f}" for value in wander[m])


def _sight_spreads(sights: Sequence[Hover]) -> Iterator[tuple[str, ...]]:
    ends, wander = _ends(sights), np.array([it.wander for it in sights]).mean(axis=0)
    yield "P2, Table I: visual odometry (SVO)", *(f"{value:.3f}" for value in SVO), "", ""
    cells = ("{:.3f} ({:.3f} to {:.3f})".format(*spread(ends[:, 0, a])) for a in (0, 1))
    yield _by_sight(sights), *cells, *(f"{value:.2f}" for value in wander[0])


def _by_sight(sights: Sequence[Hover]) -> str:
    return f"`ud_vision_ekf`, {len(sights)} flights"


def _others(hovers: Sequence[Hover], methods: Sequence[str]) -> Iterator[tuple[str, ...]]:
    ends = _ends(hovers)
    speed = np.sqrt(np.square([it.velocity for it in hovers]).mean(axis=0))
    claims = np.array([it.claimed for it in hovers])
    for m, name in enumerate(methods):
        claimed, inside = "", ""
        if np.isfinite(claims[:, m]).all():
            claimed = f"{claims[:, m].mean():.2f} m"
            inside = f"{100.0 * (np.abs(ends[:, m]) < 1.96 * claims[:, m, None]).mean():.0f} %"
        means = (f"{v:.2f} ± {s:.2f} m" for v, s in zip(*_means(ends[:, m]), strict=True))
        yield name, *(f"{v:.3f} m/s" for v in speed[m]), *means, claimed, inside


def _means(ends: Mat) -> tuple[list[float], list[float]]:
    """Return the mean of (n, 2) and its standard error, each (2,)."""
    error = ends.std(axis=0, ddof=1) / math.sqrt(len(ends))
    return ends.mean(axis=0).tolist(), error.tolist()


def _assumed() -> Iterator[tuple[str, str]]:
    world, sensors = World(world="hall"), Sensors()
    for name in ("imu", "flow", "range", "baro", "magnetometer"):
        yield name, numbers(getattr(sensors, name))
    yield "inner autopilot", numbers(world.autopilot)
    yield "navigation: flow_kalman", numbers(ESTIMATING)
    yield "navigation: ud_vision_ekf", numbers(SEEING)
    yield "its camera, looking down at a floor of concrete", numbers(CAMERA)


def _ends(hovers: Sequence[Hover]) -> Mat:
    return np.array([it.errors[:, -1] for it in hovers])  # (flights, methods, 2)


def _pair(values: Sequence[float] | Mat) -> str:
    return f"{values[0]:.2f} m (x), {values[1]:.2f} m (y)"


def _fine(values: Sequence[float] | Mat) -> str:
    return f"{values[0]:.3f} m (x), {values[1]:.3f} m (y)"


def _ratio(value: float, low: float, high: float) -> str:
    return f"{value:.1f} ({low:.1f} to {high:.1f})"


def main(arguments: Sequence[str] | None = None) -> None:
    """Hover over many seeds and write up how far each navigator was off."""
    parser = argparse.ArgumentParser(prog="python -m studies.hover", description=main.__doc__)
    parser.add_argument("--seeds", type=int, default=200)
    parser.add_argument("--sights", type=int, default=20, help="seeds of flights with a camera")
    parser.add_argument("--length", type=float, default=300.0, help="s")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    chosen = parser.parse_args(arguments)
    flights = hover_all(chosen.seeds, chosen.length, chosen.workers)
    hovers = list(track(flights, "hovering", chosen.seeds, disable=not sys.stderr.isatty()))
    seen = hover_all(chosen.sights, chosen.length, chosen.workers, hover_by_sight)
    sights = list(track(seen, "by sight", chosen.sights, disable=not sys.stderr.isatty()))
    command = f"python -m studies.hover --seeds {chosen.seeds} --length {chosen.length:g}"
    write(hovers, sights, chosen.length, chosen.out, f"{command} --sights {chosen.sights}")
    print(verdict(hovers, sights))  # noqa: T201


def write(
    hovers: Sequence[Hover], sights: Sequence[Hover], length: float, out: Path, command: str
) -> None:
    """Write the page and its picture into the folder `out`."""
    out.mkdir(parents=True, exist_ok=True)
    (out / "hover.md").write_text(page(hovers, sights, length, command), encoding="utf-8")
    said = _pair(_ends(hovers)[:, P2].std(axis=0, ddof=1))
    subtitle = f"{len(hovers)} flights of {length:g} s; P2's filter: {said}"
    draw(out / "hover.png", hovers, PAPER, floor(length), subtitle)


if __name__ == "__main__":
    main()
