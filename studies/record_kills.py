"""The end of a killed flight's record: `python -m studies.record_kills`."""

from __future__ import annotations

import argparse
import mmap
import os
import signal
import struct
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory
from typing import NamedTuple

import numpy as np

from missionkit.chart.load import parse
from missionkit.chart.plugin_catalogue import builtin
from missionkit.engine.clock import RealTime, stopwatch
from missionkit.messages import Observation, Record
from missionkit.recorder.flight_recorder import FlightRecorder
from missionkit.recorder.record_reader import read
from missionkit.recorder.record_sinks import background
from missionkit.rehearsal.rehearse import rehearse
from missionkit.rehearsal.stage import Stage, stage
from missionkit.sim.world import World

MISSION = """\
missionkit: 1
mission: stay
camera: {use: none}
initial: idle
states:
  idle: {kind: idle, behavior: {use: take_off, height: 2.5}, transitions: [{to: up, when: done}]}
  up: {kind: custom, transitions: [{to: land, after: 60}]}
  land: {kind: land}
"""
PAGE = """# Study: how far the record of a killed flight reaches

A flight in real time, written as over a vehicle: by a thread behind the flight. Its process is
killed (SIGKILL) at a random moment, and the record is read back.

    {command}

- Between the kill and the last tick in the record: {middle:.3f} s (median), {most:.3f} s at most.
- Ticks that had begun and are not in the record: {lost}.

A tick lasts 0.05 s: one that is under way at the kill is not recorded yet.
"""
NOTE = struct.Struct("dd")
EARLIEST, LATEST = 1.0, 9.0  # s of the flight


class Killed(NamedTuple):
    """Loss through one kill."""

    seconds: float  # from the last tick in the record to the kill
    ticks: int  # that had begun and are not in the record


def killed(ready: Stage, folder: Path, after: float) -> Killed:
    """Fly in a process of its own, kill that `after` s (wall), and read its record."""
    with mmap.mmap(-1, NOTE.size) as note:
        child = os.fork()
        if child == 0:
            _fly(ready, folder, note)
        while not any(note[:]):
            os.sched_yield()
        _wait(after)
        os.kill(child, signal.SIGKILL)
        at = stopwatch()
        os.waitpid(child, 0)
        began, now = NOTE.unpack(note[:])
    last = max(entry.at for entry in read(folder / "flight.mcap", "/pose"))
    return Killed(now + (at - began) - last, round((now - last) / ready.plan.period))


def _fly(ready: Stage, folder: Path, note: mmap.mmap) -> None:
    """Fly, and say when each tick was over and which it was; never returns."""
    recorder = FlightRecorder(folder, sink=background().record)

    def observe(record: Record, seen: Observation) -> None:
        recorder.write(record, seen.frame)
        note[:] = NOTE.pack(stopwatch(), record.now)

    rehearse(ready, [observe], pace=RealTime())
    os._exit(0)


def _wait(seconds: float) -> None:
    time.sleep(seconds)  # noqa: TID251 - the kill comes from outside of any flight


def page(found: Sequence[Killed], command: str) -> str:
    """Return the page of the study."""
    gaps = [each.seconds for each in found]
    ticks = [each.ticks for each in found]
    lost = ", ".join(f"{n} in {ticks.count(n)} of {len(ticks)}" for n in sorted(set(ticks)))
    return PAGE.format(command=command, middle=median(gaps), most=max(gaps), lost=lost)


def main(arguments: Sequence[str]) -> None:
    """Run the study and print its page."""
    parser = argparse.ArgumentParser(prog="studies.record_kills")
    parser.add_argument("--kills", type=int, default=40)
    parser.add_argument("--seed", type=int, default=0)
    wanted = parser.parse_args(arguments)
    catalogue = builtin()
    mission = parse(MISSION, "stay.yaml", catalogue)
    moments = np.random.default_rng(wanted.seed).uniform(EARLIEST, LATEST, wanted.kills)
    found = []
    with TemporaryDirectory() as name:
        for number, after in enumerate(moments.tolist()):
            ready = stage(mission, catalogue, World(world="field"), number)
            folder = Path(name, str(number))
            folder.mkdir()
            found.append(killed(ready, folder, after))
            print(found[-1], file=sys.stderr)  # noqa: T201
    command = f"python -m studies.record_kills --kills {wanted.kills} --seed {wanted.seed}"
    print(page(found, command))  # noqa: T201


if __name__ == "__main__":
    main(sys.argv[1:])
