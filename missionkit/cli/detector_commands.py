"""`missionkit detector`: trains what finds ground robots in camera frames."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from missionkit.cli.command_options import reporting_errors

detector = typer.Typer(help="Train detectors of ground robots.", no_args_is_help=True)


@detector.callback()
def _group() -> None:
    """Train detectors of ground robots."""


@detector.command()
@reporting_errors
def train(
    out: Annotated[Path, typer.Option(metavar="FILE.yaml", help="the trained detector")],
    kind: Annotated[str, typer.Option(help="haar or template")] = "haar",
    world: Annotated[
        list[Path] | None,
        typer.Option(
            metavar="WORLD.yaml",
            help="whose floor, lines and plates are shown; four plain floors without",
        ),
    ] = None,
    pictures: Annotated[int, typer.Option(min=10, help="rendered")] = 1200,
    positives: Annotated[int, typer.Option(min=10, help="windows that show a robot")] = 2500,
    negatives: Annotated[int, typer.Option(min=10, help="windows that do not, a stage")] = 3000,
    tests: Annotated[int, typer.Option(min=1, help="pictures of each kind of test")] = 100,
    seed: Annotated[int, typer.Option(min=0, help="of all chance")] = 0,
) -> None:
    """Render ground robots from above, train on them, and test on worlds that differ."""
    from missionkit.cli.detector_training import TrainingOptions  # noqa: PLC0415
    from missionkit.cli.detector_training import train as command  # noqa: PLC0415

    given = TrainingOptions(kind, tuple(world or ()), pictures, positives, negatives, tests, seed)
    command(given, out)
