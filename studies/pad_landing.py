"""Landing on a pad in wind: `python -m studies.pad_landing`."""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Sequence
from pathlib import Path
from string import Template
from typing import NamedTuple

import numpy as np
from rich.progress import track

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.messages import Observation, Record
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import stage, world_of
from missionkit.sim.deck import Deck, DeckMarker
from missionkit.sim.world import World
from studies.markdown import table
from studies.parallel import in_parallel
from studies.statistics import wilson

MISSION = Path(__file__).parents[1] / "missions" / "pad_landing.yaml"
TEMPLATE = Path(__file__).with_suffix(".md")
WIND = 5.0  # m/s, mean; its direction is drawn
NEAR = 0.10  # m
MET_AFTER = 12.0  # s, when a deck that drives is about where it was surveyed
STILL = "windy pad"


class PadCase(NamedTuple):
    """What is landed on."""

    speed: float = 0.0  # m/s
    tilt_deg: float = 0.0
    turn_rate_deg: float = 0.0
    on_deck: bool = True


CASES = {
    STILL: PadCase(on_deck=False),
    "deck, leaning 8 deg": PadCase(tilt_deg=8.0),
    "deck, 0.5 m/s": PadCase(0.5),
    "deck, 1 m/s": PadCase(1.0),
    "deck, 0.8 m/s, leaning 5 deg, course turning by 10 deg/s": PadCase(0.8, 5.0, 10.0),
}


class Order(NamedTuple):
    """One flight to be flown."""

    case: str
    seed: int
    camera: str


class Landing(NamedTuple):
    """Result of one flight."""

    order: Order
    missed: float  # m, level, from the middle of the pad at the first touch
    sank: float  # m/s, before the touch
    on_pad: bool  # it stands on what it was to land on
    crashed: bool
    aborts: int
    succeeded: bool


def flown(order: Order) -> Landing:
    """Fly one landing and judge it by the truth."""
    case = CASES[order.case]
    rng = np.random.default_rng([order.seed, 16])
    text = MISSION.read_text(encoding="utf-8")
    if case.on_deck:
        text = text.replace("[15.0, 0.0, 0.0]", "[15.0, 0.0, -0.5]")
    if case.speed:
        text = text.replace("visual_inertial_ekf}", "visual_inertial_ekf, moving: {pad: 1.5}}")
    mission = parse(text, str(MISSION), builtin())
    eye = mission.camera.model_copy(update={"use": order.camera})
    mission = mission.model_copy(update={"camera": eye})
    world, deck = _blown(world_of(mission, MISSION.parent), case, rng)
    ready = stage(mission, builtin(), world, order.seed)
    aborts = 0

    def watch(record: Record, _: Observation) -> None:
        nonlocal aborts
        aborts += "pad.aborted" in record.estimate.events

    result = rehearse(ready, (watch,))
    rows = ready.vehicle.track.rows
    last = int(np.flatnonzero(rows[:, 14] == 0.0)[-1])
    touch = rows[min(last + 1, len(rows) - 1)]
    north, east = _middle(world, deck, float(touch[0]))
    missed = math.hypot(touch[1] - north, touch[2] - east)
    on_pad = missed < (1.0 if deck is not None else 0.3)
    sank = float(rows[last, 6])
    crashed = result.grade.crashed
    return Landing(order, missed, sank, on_pad, crashed, aborts, result.succeeded)


def _blown(world: World, case: PadCase, rng: np.random.Generator) -> tuple[World, Deck | None]:
    """Return the world with wind from somewhere, and its deck, which drives and leans somewhere."""
    wind, course, lean = rng.uniform(0.0, 2.0 * math.pi, 3).tolist()
    mean = (WIND * math.cos(wind), WIND * math.sin(wind), 0.0)
    world = world.model_copy(update={"wind": world.wind.model_copy(update={"mean": mean})})
    if not case.on_deck:
        return world, None
    deck = Deck(
        at=(0.0, 0.0),
        height=0.5,
        size=2.0,
        tilt_deg=case.tilt_deg,
        facing_deg=math.degrees(lean),
        velocity=(case.speed * math.cos(course), case.speed * math.sin(course)),
        turn_rate_deg=case.turn_rate_deg,
        markers=tuple(
            DeckMarker(dictionary=it.dictionary, id=it.id, size=it.size) for it in world.markers[:2]
        ),
    )
    north, east, _ = world.markers[0].position
    shift = deck.shift(MET_AFTER)
    deck = deck.model_copy(update={"at": (north - shift[0], east - shift[1])})
    return world.model_copy(update={"deck": deck, "markers": ()}), deck


def _middle(world: World, deck: Deck | None, now: float) -> tuple[float, float]:
    """Return where the middle of the pad is (m, north and east)."""
    if deck is None:
        north, east, _ = world.markers[0].position
        return north, east
    shift = deck.shift(now)
    return deck.at[0] + shift[0], deck.at[1] + shift[1]


def verdict(runs: Sequence[Landing]) -> str:
    """Return what the flights to the pad on the ground gave."""
    own = [run for run in runs if run.order.case == STILL]
    near = sum(run.missed <= NEAR for run in own)
    low, high = wilson(near, len(own))
    crashed = sum(run.crashed for run in own)
    met = "met" if near >= 0.98 * len(own) and not crashed else "missed"
    return (
        f"{near} of {len(own)} landings touched down within {100 * NEAR:.0f} cm "
        f"({100 * near / len(own):.1f} %, 95 % interval {100 * low:.1f} to {100 * high:.1f} %), "
        f"{crashed} crashed; wanted at least 98 % and no crash: {met}."
    )


def page(runs: Sequence[Landing], command: str) -> str:
    """Return the page in Markdown; `command` is what produced it."""
    parts = {"command": command, "verdict": verdict(runs), "table": _table(runs)}
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(parts)


def _table(runs: Sequence[Landing]) -> str:
    rows = []
    for case in CASES:
        own = [run for run in runs if run.order.case == case]
        if not own:
            continue
        misses = 100.0 * np.array([run.missed for run in own])
        near = sum(run.missed <= NEAR for run in own)
        low, high = wilson(near, len(own))
        rows.append(
            (
                case,
                str(len(own)),
                str(sum(run.on_pad for run in own)),
                f"{near} ({100 * low:.0f} to {100 * high:.0f} %)",
                ", ".join(f"{it:.1f}" for it in (*np.quantile(misses, [0.5, 0.95]), misses.max())),
                f"{max(run.sank for run in own):.2f}",
                str(sum(run.aborts for run in own)),
                str(sum(run.crashed for run in own)),
            )
        )
    header = (
        "pad",
        "flights",
        "on it",
        "within 10 cm",
        "miss, cm: median, 95 %, most",
        "most sink, m/s",
        "aborts",
        "crashes",
    )
    return table(header, rows)


def main(arguments: Sequence[str] | None = None) -> None:
    """Fly landings over many seeds and write them up."""
    parser = argparse.ArgumentParser(prog="python -m studies.pad_landing", description=main.__doc__)
    parser.add_argument("--seeds", type=int, default=200, help="flights to the pad on the ground")
    parser.add_argument("--decks", type=int, default=50, help="flights to each deck")
    parser.add_argument("--first", type=int, default=1000, metavar="SEED")
    parser.add_argument("--camera", choices=("rendered", "corners"), default="rendered")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    chosen = parser.parse_args(arguments)
    orders = [
        Order(case, chosen.first + n, chosen.camera)
        for case in CASES
        for n in range(chosen.seeds if case == STILL else chosen.decks)
    ]
    flights = in_parallel(flown, orders, chosen.workers)
    runs = list(track(flights, "flying", len(orders), disable=not sys.stderr.isatty()))
    command = (
        f"python -m studies.pad_landing --seeds {chosen.seeds} --decks {chosen.decks} "
        f"--first {chosen.first} --camera {chosen.camera}"
    )
    chosen.out.mkdir(parents=True, exist_ok=True)
    (chosen.out / "pad_landing.md").write_text(page(runs, command), encoding="utf-8")
    print(verdict(runs))  # noqa: T201


if __name__ == "__main__":
    main()
