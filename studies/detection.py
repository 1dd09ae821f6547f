"""P4's detectors, alone and fused, on rendered pictures: `python -m studies.detection`."""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from functools import partial
from pathlib import Path
from string import Template

import numpy as np

from studies.detection_figure import draw
from studies.detection_runs import DETECTORS, GROUPS, Answers, group
from studies.markdown import table
from studies.parallel import in_parallel
from studies.statistics import wilson

TEMPLATE = Path(__file__).with_name("detection.md")
TRAINED, UNSEEN = "as trained", "other floors"
FALSE = 0.1  # a picture, at most
SHOWN = ("haar", "template", "fused")
Results = Mapping[str, Mapping[str, Answers]]  # group -> detector -> what it found


def verdict(results: Results) -> str:
    """Return the results in a few lines."""
    lines = []
    for name in (TRAINED, UNSEEN):
        it = results[name]["haar"]
        least = max(it.least_for(FALSE), DEFAULT)
        lines.append(
            f"- Haar, floors {'as trained' if name == TRAINED else 'never seen'}: "
            f"{_share(it, least)} found, {it.false(least):.3f} false a picture."
        )
    gated, free = (results[TRAINED][it] for it in ("haar", "haar, no gate"))
    ratio = np.median(free.times) / np.median(gated.times)
    lines.append(
        f"- Searched at the predicted size only it is {ratio:.0f} times as fast, "
        f"{1e3 * np.median(gated.times):.1f} ms a picture (median; 99 %: "
        f"{1e3 * np.percentile(gated.times, 99):.1f}), and {gated.false(DEFAULT):.3f} instead of "
        f"{free.false(DEFAULT):.3f} are false a picture."
    )
    return "\n".join(lines)


DEFAULT = 0.2
"""Least score of what counts, as the detector has it."""


def _share(it: Answers, least: float) -> str:
    found = int((it.right >= least).sum())
    low, high = wilson(found, it.robots)
    return f"{found} of {it.robots} ({100.0 * low:.1f} to {100.0 * high:.1f} %)"


def page(results: Results, command: str) -> str:
    """Return the page."""
    return Template(TEMPLATE.read_text(encoding="utf-8")).substitute(
        command=command,
        verdict=verdict(results),
        pictures=results[TRAINED]["haar"].pictures,
        curves=table(
            ("pictures", "detector", "found at 0.1 false", "found at 0.01 false", "cm"),
            [row for name in (TRAINED, UNSEEN) for row in _curves(name, results[name])],
        ),
        groups=table(
            ("pictures", "haar: found", "false", "fused: found", "false"),
            [_group(name, it) for name, it in results.items()],
        ),
        gate=table(
            ("search", "found", "false a picture", "ms, median (99 %)"),
            [_searched(name, results[TRAINED][name]) for name in DETECTORS],
        ),
    )


def _curves(name: str, answers: Mapping[str, Answers]) -> list[tuple[str, ...]]:
    rows = []
    for detector in SHOWN:
        it = answers[detector]
        cells = (f"{100.0 * it.recall(it.least_for(false)):.1f} %" for false in (FALSE, 0.01))
        error = 100.0 * float(np.median(it.errors)) if len(it.errors) else 0.0
        rows.append((name, detector, *cells, f"{error:.1f}"))
    return rows


def _group(name: str, answers: Mapping[str, Answers]) -> tuple[str, ...]:
    haar, both = answers["haar"], answers["fused"]
    return (
        *(name, _share(haar, DEFAULT), f"{haar.false(DEFAULT):.3f}"),
        *(_share(both, DEFAULT), f"{both.false(DEFAULT):.3f}"),
    )


def _searched(name: str, it: Answers) -> tuple[str, ...]:
    p50, p99 = np.percentile(1e3 * it.times, (50, 99))
    share = f"{100.0 * it.recall(DEFAULT):.1f} %"
    return name, share, f"{it.false(DEFAULT):.3f}", f"{p50:.1f} ({p99:.1f})"


def write(results: Results, out: Path, command: str, seed: int) -> None:
    """Write the page and its picture.

    Args:
        results: by group and detector.
        out: folder.
        command: that produced it.
        seed: of the pictures that are shown.
    """
    out.mkdir(parents=True, exist_ok=True)
    (out / "detection.md").write_text(page(results, command), encoding="utf-8")
    draw(out / "detection.png", results, seed)


def _of(name: str, pictures: int, first: int) -> dict[str, Answers]:
    seed = first + list(GROUPS).index(name)
    return group(name, pictures, seed, ablation=name == TRAINED)


def main(arguments: Sequence[str] | None = None) -> None:
    """Look for robots in rendered pictures and write up how well."""
    parser = argparse.ArgumentParser(prog="python -m studies.detection", description=main.__doc__)
    parser.add_argument("--pictures", type=int, default=300, help="of each group")
    parser.add_argument("--first", type=int, default=0, help="seed of the first group")
    parser.add_argument("--workers", type=int, default=1, help="processes")
    parser.add_argument("--out", type=Path, default=Path("docs/studies"))
    chosen = parser.parse_args(arguments)
    run = partial(_of, pictures=chosen.pictures, first=chosen.first)
    answers = in_parallel(run, list(GROUPS), chosen.workers)
    results: Results = dict(zip(GROUPS, answers, strict=True))
    words = f"--pictures {chosen.pictures} --first {chosen.first}"
    write(results, chosen.out, f"python -m studies.detection {words}", chosen.first + 50)
    print(verdict(results))  # noqa: T201


if __name__ == "__main__":
    main()
