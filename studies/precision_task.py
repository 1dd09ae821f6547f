"""The precision task over many seeds: `python -m studies.precision_task`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path

from rich.progress import track

from missionkit.sim.fault_injection import FAULT_KINDS
from studies.faults_figure import draw_faults
from studies.flight import Camera, Order, Run, fly_all
from studies.flights_figure import draw_flights
from studies.report import Results, harm, headline, page, verdict

DELAYS = range(1, 7)  # s after entry to visual, which lasts 8 s at least
HIDDEN = 6  # s
VALUES = {"battery_sag": 0.7}  # the default leaves enough for the whole mission
MOMENTS = {
    "gps:8": "8 s into gps",
    "visual:3": "3 s into visual",
    "task:2": "2 s into task",
    "return:5": "5 s into return",
}


def nominal(seeds: Sequence[int], camera: Camera) -> list[Order]:
    """Return flights with nothing wrong but wind and noise."""
    return [Order(seed, camera) for seed in seeds]


def hidden(seeds: Sequence[int], camera: Camera) -> list[Order]:
    """Return flights that lose the marker while servoing, at moments spread over the approach."""
    delays = [DELAYS[seed % len(DELAYS)] for seed in seeds]
    return [
        Order(seed, camera, (f"marker_hidden@visual:{delay}+{HIDDEN}",))
        for seed, delay in zip(seeds, delays, strict=True)
    ]


def swept(
    seeds: Sequence[int], kinds: Iterable[str] = FAULT_KINDS
) -> dict[tuple[str, str], list[Order]]:
    """Return flights by fault and moment; every fault stays to the end."""
    return {
        (fault, words): [Order(seed, "corners", (f"{fault}@{when}",)) for seed in seeds]
        for fault in map(_with_value, kinds)
        for when, words in MOMENTS.items()
        if seeds
    }


def _with_value(kind: str) -> str:
    value = VALUES.get(kind, FAULT_KINDS[kind].value)
    return kind if value is None else f"{kind}={value:g}"


def flown(
    first: Sequence[Order],
    second: Sequence[Order],
    cells: dict[tuple[str, str], list[Order]],
    workers: int,
) -> Results:
    """Fly everything, with a bar that shows how far it is."""
    orders = [*first, *second, *(order for cell in cells.values() for order in cell)]
    flights = fly_all(orders, workers)
    runs = list(track(flights, "flying", len(orders), disable=not sys.stderr.isatty()))
    by_order: dict[Order, Run] = {run.order: run for run in runs}
    found = {key: [by_order[order] for order in cell] for key, cell in cells.items()}
    return Results([by_order[o] for o in first], [by_order[o] for o in second], found)


def write(results: Results, out: Path, command: str) -> None:
    """Write the page and its two pictures into the folder `out`."""
    out.mkdir(parents=True, exist_ok=True)
    (out / "precision_task.md").write_text(page(results, command), encoding="utf-8")
    draw_flights(out / "precision_task.png", results.groups, headline(results.nominal))
    if results.swept:
        subtitle = f"{len(results.swept)} flights: {harm(results.swept)}"
        draw_faults(out / "precision_task_faults.png", results.faults, subtitle)


def main(arguments: Sequence[str] | None = None) -> None:
    """Fly the precision task over many seeds and write up the results."""
    parser = argparse.ArgumentParser(
        prog="python -m studies.precision_task", description=main.__doc__
    )
    parser.add_argument("--seeds", type=int, default=100, help="nominal flights")
    parser.add_argument("--first", type=int, default=0, metavar="SEED", help="of every group")
    parser.add_argument("--hidden", type=int, default=50, help="flights with the marker hidden")
    parser.add_argument("--sweep", type=int, default=5, help="flights per fault and moment")
    parser.add_argument("--camera", choices=("rendered", "corners"), default="rendered")
    parser.add_argument("--workers", type=int, default=2, help="processes")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    chosen = parser.parse_args(arguments)

    def seeds(many: int) -> Sequence[int]:
        return range(chosen.first, chosen.first + many)

    results = flown(
        nominal(seeds(chosen.seeds), chosen.camera),
        hidden(seeds(chosen.hidden), chosen.camera),
        swept(seeds(chosen.sweep)),
        chosen.workers,
    )
    command = (
        f"python -m studies.precision_task --seeds {chosen.seeds} --first {chosen.first} "
        f"--hidden {chosen.hidden} --sweep {chosen.sweep} --camera {chosen.camera}"
    )
    write(results, chosen.out, command)
    print(verdict(results))  # noqa: T201


if __name__ == "__main__":
    main()
