"""A simulated autopilot of its own for one run: started, flown, ended whatever happens."""

from __future__ import annotations

import json
import os
import selectors
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from missionkit.api.vehicle_flight import lands_precisely
from missionkit.chart.model.mission import Mission
from missionkit.errors import UsageError, VehicleError

DIALECTS = ("px4", "ardupilot")
STARTING = 180.0  # s; kernels that are not in the cache are compiled first
ENDING = 5.0  # s until what does not end is killed


@contextmanager
def simulated_autopilot(
    dialect: str,
    mission: Mission,
    folder: Path,
    *,
    speed: float = 1.0,
    seed: int = 0,
    faults: tuple[str, ...] = (),
    system: int = 1,
) -> Iterator[str]:
    """Yield the address of an autopilot that simulates the mission's world; end it afterwards.

    It is a process in a session of its own, so that Ctrl-C, which lands the vehicle, does not reach
    it. It ends when its standard input closes: also if this process is killed.

    Args:
        dialect: px4 or ardupilot.
        mission: says which world, and where on the earth it is.
        folder: of the mission.
        speed: times real time.
        seed: of everything random in it.
        faults: of `missionkit sitl`.
        system: its MAVLink system id.

    Raises:
        UsageError: the dialect, or a fault, does not exist, or the vehicle is no multicopter.
        VehicleError: it does not start.
    """
    if dialect not in DIALECTS:
        raise UsageError(f"--sitl {dialect}: must be one of {', '.join(DIALECTS)}")
    if mission.vehicle.use != "sim":
        raise UsageError(f"--sitl simulates a multicopter, not vehicle {mission.vehicle.use!r}")
    words = [*_options(dialect, mission, folder, speed, seed, faults), "--system", str(system)]
    process, port = _started(words)
    try:
        yield f"udpin://127.0.0.1:{port}"
    finally:
        _end(process)


def _options(
    dialect: str, mission: Mission, folder: Path, speed: float, seed: int, faults: tuple[str, ...]
) -> list[str]:
    words = ["--dialect", dialect, "--speed", repr(speed), "--seed", str(seed)]
    if mission.world is not None:
        words += ["--world", str(folder / mission.world)]
    if (place := mission.origin) is not None:
        words.append(f"--home={place.lat!r},{place.lon!r},{place.alt!r}")
    if (start := mission.vehicle.start) is not None:
        words.append(f"--start={start[0]!r},{start[1]!r}")
    if dialect == "ardupilot" and lands_precisely(mission):
        words += ["--parameter", "PLND_ENABLED=1"]
    return [*words, *(word for fault in faults for word in ("--fault", fault))]


def _started(words: list[str]) -> tuple[subprocess.Popen[bytes], int]:
    port = _free_port()
    process = subprocess.Popen(  # noqa: S603 - this program itself
        [
            *(sys.executable, "-m", "missionkit", "sitl", "--json", "--tied"),
            *("--link", f"udpout:127.0.0.1:{port}", *words),
        ],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )
    try:
        _wait(process)
    except BaseException:
        _end(process)
        raise
    return process, port


def _wait(process: subprocess.Popen[bytes]) -> None:
    """Wait until it says where it can be reached."""
    answers, complaints = process.stdout, process.stderr
    if answers is None or complaints is None:
        raise VehicleError("the simulated autopilot has no output")
    with selectors.DefaultSelector() as selector:
        selector.register(answers, selectors.EVENT_READ)
        line = answers.readline() if selector.select(STARTING) else b""
    with suppress(ValueError):
        if "links" in json.loads(line):
            return
    if not line:
        with suppress(subprocess.TimeoutExpired):
            process.wait(ENDING)  # it has ended by itself, and said why
    process.kill()
    said = complaints.read().decode(errors="replace").strip()
    process.wait()
    why = said.splitlines()[-1] if said else f"it said nothing for {STARTING:g} s"
    if process.returncode == 2:
        raise UsageError(f"the simulated autopilot: {why.removeprefix('error: ')}")
    raise VehicleError(f"the simulated autopilot did not start: {why}")


def _free_port() -> int:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def _end(process: subprocess.Popen[bytes]) -> None:
    """End it and all that it started: gently, then by force."""
    if process.stdin is not None:
        with suppress(OSError):
            process.stdin.close()
    for number in (None, signal.SIGTERM, signal.SIGKILL):
        if number is not None:
            with suppress(ProcessLookupError, PermissionError):
                os.killpg(process.pid, number)
        with suppress(subprocess.TimeoutExpired):
            process.wait(ENDING)
            break
    for pipe in (process.stdout, process.stderr):
        if pipe is not None:
            pipe.close()
