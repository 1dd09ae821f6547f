"""Flights with journals for the studies of replays: two missions, with camera corners."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from shutil import copytree

import missionkit

MISSIONS = Path(__file__).parents[1] / "missions"
ERRAND = """\
missionkit: 1
mission: errand
params: {cruise: 4.0}
camera: {use: none}
targets: {pole: {position: [20.0, 5.0, -3.0]}}
guards:
  close: {use: near_goal, radius: 1.0}
failsafes:
  - {name: battery, when: {use: battery_below, floor: 0.20}, to: back}
  - {name: empty, when: {use: battery_below, floor: 0.10}, unknown: ignore, to: land}
initial: idle
states:
  idle:
    kind: idle
    behavior: {use: take_off, height: 3}
    transitions:
      - {to: out, when: done}
  out:
    kind: gps
    behavior: {use: go_to, target: pole, standoff: [3.0, 0.0, 0.0], speed: $cruise}
    transitions:
      - {to: look, when: {all: [close, {use: within, of: pole, radius: 3.6}]}, for: 0.5}
      - {to: back, after: 40}
  look:
    kind: gps
    behavior: {use: hold}
    transitions:
      - {to: back, after: 4}
      - {to: land, when: {not: close}, for: 2.0}
  back:
    kind: return
    behavior: {use: go_to, target: home, height: 3, speed: $cruise}
    transitions:
      - {to: land, when: done}
  land: {kind: land}
"""


def flown(name: str, seeds: Sequence[int], folder: Path) -> list[Path]:
    """Fly a mission once for each seed, and return the folders of the runs.

    Args:
        name: "errand", or a mission of this repository.
        seeds: of the flights.
        folder: where; it gets the mission's files too.
    """
    files = folder / f"{name}-files"
    copytree(MISSIONS, files)
    path = files / f"{name}.yaml"
    text = ERRAND if name == "errand" else path.read_text(encoding="utf-8")
    path.write_text(text.replace("use: rendered", "use: corners"), encoding="utf-8")
    mission = missionkit.load(path)
    runs = [folder / f"{name}-{seed}" for seed in seeds]
    for seed, run in zip(seeds, runs, strict=True):
        missionkit.rehearse(mission, seed=seed, folder=run)
    return runs
