"""`missionkit detector train`."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Final, NamedTuple

from missionkit.errors import UsageError, nearest
from missionkit.perception.haar.training import TrainingPlan
from missionkit.sim.detector_samples import of_worlds
from missionkit.sim.detector_training import KINDS, DetectionRow, Order, tested
from missionkit.sim.world_files import load_multicopter_world

LEAST_SCORE: Final = 0.5  # of what counts in the tests


class TrainingOptions(NamedTuple):
    """What the command line asks for."""

    kind: str
    worlds: tuple[Path, ...]
    pictures: int
    positives: int
    negatives: int
    tests: int
    seed: int


def train(given: TrainingOptions, out: Path) -> None:
    """Train a detector, test it, and write its file.

    Raises:
        UsageError: the kind is unknown, the file's name is wrong or it cannot be written, or
            there is too little to train with.
        FileError: a world cannot be used.
    """
    if given.kind not in KINDS:
        raise UsageError(f"--kind {given.kind}: no such detector; {nearest(given.kind, KINDS)}")
    if out.suffix not in {".yaml", ".yml"}:
        raise UsageError(f"--out {out}: expected a name that ends in .yaml")
    domain = of_worlds([load_multicopter_world(path) for path in given.worlds])
    plan = TrainingPlan(positives=given.positives, negatives=given.negatives)
    order = Order(domain, given.pictures, plan, given.seed)
    try:
        text = KINDS[given.kind](order, _progress)
    except ValueError as error:
        raise UsageError(str(error)) from error
    for row in tested(given.kind, text, domain, given.tests, given.seed, LEAST_SCORE):
        print(_sentence(row))  # noqa: T201
    try:
        out.write_text(text, encoding="utf-8")
    except OSError as error:
        raise UsageError(f"{out}: the detector cannot be written: {error.strerror}") from error
    print(f"wrote {out}: {len(text) / 1e3:.0f} kB")  # noqa: T201


def _progress(line: str) -> None:
    print(line, file=sys.stderr, flush=True)  # noqa: T201


def _sentence(row: DetectionRow) -> str:
    share = row.found / row.robots if row.robots else 0.0
    return (
        f"{row.name}: {row.found} of {row.robots} robots found ({share:.1%}), "
        f"{row.false / max(row.pictures, 1):.3f} false a frame"
    )
