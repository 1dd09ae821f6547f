"""One flight that is killed and resumed, each part in a process of its own."""

from __future__ import annotations

import json
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from typing import Any, NamedTuple

from missionkit.cli.resume_rehearsal import Contents
from missionkit.errors import UsageError
from missionkit.recorder.checkpoint import load
from studies.flight import MISSION, Camera

SPEED = 20.0  # times real time until the kill, so that it can be aimed at a tick
POLL = 0.005  # s
PERIOD = 0.05  # s


class Kill(NamedTuple):
    """Which flight, and the tick at which its process is killed."""

    seed: int
    tick: int
    gap: float  # s until it is resumed

    @property
    def at(self) -> float:
        """Mission time of the tick (s)."""
        return self.tick * PERIOD


class Survived(NamedTuple):
    """Result of one killed and resumed flight."""

    kill: Kill
    state: str  # the newest checkpoint's
    saved_at: float  # s, mission time of that checkpoint
    resumed: str  # how it was found on resuming
    outcome: str
    reason: str
    landed: bool
    finished: bool  # the work itself was finished
    error: float | None  # m, on arrival


def copied(folder: Path, camera: Camera) -> Path:
    """Return a copy of the mission under study, with its world, that has this camera."""
    text = MISSION.read_text(encoding="utf-8").replace("use: rendered", f"use: {camera}")
    mission = folder / MISSION.name
    mission.write_text(text, encoding="utf-8")
    shutil.copytree(MISSION.parent / "worlds", folder / "worlds", dirs_exist_ok=True)
    return mission


def survived(mission: Path, kill: Kill) -> Survived:
    """Fly, kill, resume."""
    runs = mission.parent / "runs"
    folder = runs / f"precision-task-seed{kill.seed}"
    shutil.rmtree(folder, ignore_errors=True)
    line = [str(mission), "--seed", str(kill.seed), "--speed", str(SPEED), "--out", str(runs)]
    with _started(line) as process:
        _wait(process, folder, kill.at)
        process.kill()
    saved = _contents(folder)
    if saved is None:
        raise RuntimeError(f"{kill}: killed before its first checkpoint")
    memory = saved.kept.course.memory
    with _started(["--resume", str(folder), "--gap", str(kill.gap)]) as process:
        said, wrong = process.communicate()
    if not said:
        raise RuntimeError(f"{kill}: {wrong}")
    return _judged(kill, memory.chart.state, memory.now, json.loads(said))


def _judged(kill: Kill, state: str, saved_at: float, summary: dict[str, Any]) -> Survived:
    visit = summary["grade"]["visit"]
    ways = {(it["source"], it["to"]) for it in summary["transitions"]}
    return Survived(
        kill,
        state,
        saved_at,
        _first(text.partition("resumed after ")[2] for text in summary["problems"]),
        summary["outcome"],
        summary["reason"],
        summary["grade"]["landed"],
        ("task", "return") in ways,
        None if visit is None else visit["position_error"],
    )


def _first(texts: Iterable[str]) -> str:
    return next((text for text in texts if text), "")


def _started(arguments: list[str]) -> subprocess.Popen[str]:
    line = [sys.executable, "-m", "missionkit", "run", "--headless", "--json", *arguments]
    return subprocess.Popen(line, stdout=-1, stderr=-1, text=True)  # noqa: S603


def _wait(process: subprocess.Popen[str], folder: Path, at: float) -> None:
    """Return when a flight at `SPEED` is at mission time `at` (s), by its checkpoints."""
    saved = None
    while saved is None or saved.kept.course.memory.now < at - 1.0:
        _pass(process, POLL)
        saved = _contents(folder)
    _pass(process, max(0.0, at - saved.kept.course.memory.now) / SPEED)


def _pass(process: subprocess.Popen[str], seconds: float) -> None:
    try:
        process.wait(seconds)
    except subprocess.TimeoutExpired:
        return
    raise RuntimeError(f"ended before it could be killed: {process.communicate()}")


def _contents(folder: Path) -> Contents | None:
    """Return what the newest checkpoint holds; None before the first."""
    try:
        contents: Contents = load(folder).value
    except UsageError:
        return None
    return contents
