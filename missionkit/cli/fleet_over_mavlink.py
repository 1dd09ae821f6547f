"""`missionkit fleet` over MAVLink: a `missionkit run` for each vehicle, in a process of its own."""

from __future__ import annotations

import selectors
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import NamedTuple

from missionkit.api.interrupts import on_stopping_signals
from missionkit.cli.fleet_members import FleetOptions, Member
from missionkit.cli.simulated_autopilot import DIALECTS
from missionkit.engine.clock import stopwatch
from missionkit.errors import UsageError
from missionkit.recorder.fleet_summary import EncounterSummary, FleetSummary, MemberSummary
from missionkit.recorder.run_summary import Summary
from missionkit.rehearsal.fleet import member_seed
from missionkit.vehicle.link.fleet_monitor import FleetMonitor
from missionkit.vehicle.link.traffic_link import LOOPBACK, FleetPlace

LOOK_INTERVAL = 0.2  # s between two looks at the processes


class FleetProcess(NamedTuple):
    """The process that flies one vehicle."""

    member: Member
    port: int
    process: subprocess.Popen[bytes]

    @property
    def running(self) -> bool:
        """Whether it has not ended yet."""
        return self.process.poll() is None


def fly_over_mavlink(wanted: FleetOptions, members: Sequence[Member], folder: Path) -> FleetSummary:
    """Fly the fleet. Ctrl-C is passed on to every vehicle; one that is lost stops no other.

    Args:
        wanted: options of the command.
        members: missions, settings and faults.
        folder: of the fleet's run; each vehicle gets a folder in it.
    """
    monitor = FleetMonitor([it.name for it in members], wanted.separation)
    with ExitStack() as stack:
        stack.callback(monitor.close)
        crew = _started(wanted, members, folder, monitor, stack)
        stack.enter_context(_passing_on(crew))
        _watch(crew, monitor)
    return FleetSummary(
        seed=wanted.seed if wanted.sitl else None,
        vehicles=tuple(_became(it, folder) for it in crew),
        separation=wanted.separation,
        measured_by="reports",
        encounters=tuple(EncounterSummary(**it._asdict()) for it in monitor.encounters()),
    )


def check(wanted: FleetOptions, members: Sequence[Member]) -> None:
    """Refuse a fleet that cannot fly over MAVLink.

    Args:
        wanted: options of the command.
        members: missions.

    Raises:
        UsageError: a mission has no origin, or an option does not fit.
    """
    if wanted.sitl is not None and wanted.sitl not in DIALECTS:
        raise UsageError(f"--sitl {wanted.sitl}: must be one of {', '.join(DIALECTS)}")
    for member in members:
        if member.mission.model.origin is None:
            raise UsageError(
                f"{member.mission.path}: a mission of a fleet needs an 'origin' over MAVLink: its "
                "metres are from where the vehicle was armed without one"
            )
        if member.faults and wanted.sitl is None:
            raise UsageError("--fault is for simulated vehicles, not for --vehicle")


def _started(
    wanted: FleetOptions,
    members: Sequence[Member],
    folder: Path,
    monitor: FleetMonitor,
    stack: ExitStack,
) -> list[FleetProcess]:
    sockets = {it.name: stack.enter_context(_bound()) for it in members}
    ports = {name: int(it.getsockname()[1]) for name, it in sockets.items()}
    crew = []
    for number, member in enumerate(members):
        others = {name: port for name, port in ports.items() if name != member.name}
        own = sockets[member.name]
        place = FleetPlace(member.name, own.fileno(), others, monitor.port)
        (folder / member.name).mkdir()
        words = [*_words(wanted, member, number), "--fleet-place", place.write()]
        words += ["--in", str(folder / member.name)]
        with (folder / f"{member.name}.log").open("wb") as log:
            process = subprocess.Popen(  # noqa: S603 - this program itself
                words,
                stdin=subprocess.PIPE,
                stdout=log,
                stderr=log,
                pass_fds=(own.fileno(),),
                start_new_session=True,
            )
        stack.callback(_end, process)
        crew.append(FleetProcess(member, ports[member.name], process))
    for own in sockets.values():
        own.close()  # only its process holds it: who is lost is silent
    return crew


@contextmanager
def _bound() -> Iterator[socket.socket]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as own:
        own.bind((LOOPBACK, 0))
        yield own


def _words(wanted: FleetOptions, member: Member, number: int) -> list[str]:
    """Return what `missionkit run` is called with for one vehicle."""
    program = (sys.executable, "-m", "missionkit", "run")
    words = [*program, str(member.mission.path), "--headless"]
    words += [word for text in member.settings for word in ("--set", text)]
    words += [word for path in wanted.plugins for word in ("--plugin", str(path))]
    words += [word for text in member.faults for word in ("--fault", text)]
    if wanted.speed is not None:
        words += ["--speed", repr(wanted.speed)]
    if wanted.anyway:
        words.append("--anyway")
    if wanted.sitl is not None:
        seed = str(member_seed(wanted.seed, number))
        return [*words, "--sitl", wanted.sitl, "--system", str(number + 1), "--seed", seed]
    words += ["--vehicle", wanted.vehicles[number]]
    return [*words, "--system", str(wanted.systems[number])] if wanted.systems else words


def _watch(crew: Sequence[FleetProcess], monitor: FleetMonitor) -> None:
    """Listen until all have ended; let them begin once none is still getting ready."""
    with selectors.DefaultSelector() as selector:
        selector.register(monitor.socket, selectors.EVENT_READ)
        due = stopwatch()
        while any(it.running for it in crew):
            selector.select(LOOK_INTERVAL)
            monitor.listen()
            if stopwatch() < due:
                continue
            due = stopwatch() + LOOK_INTERVAL
            if all(it.member.name in monitor.ready for it in crew if it.running):
                monitor.let_begin([it.port for it in crew if it.running])


@contextmanager
def _passing_on(crew: Sequence[FleetProcess]) -> Iterator[None]:
    """Pass signals that end a program on to every vehicle, as Ctrl-C: the first one lands it."""

    def tell(_: int, __: FrameType | None) -> None:
        for it in crew:
            if it.running:
                with suppress(ProcessLookupError):
                    it.process.send_signal(signal.SIGINT)

    with on_stopping_signals(tell):
        yield


def _end(process: subprocess.Popen[bytes]) -> None:
    """Let go of a process: its vehicle lands if it still flies."""
    if process.stdin is not None:
        with suppress(OSError):
            process.stdin.close()


def _became(it: FleetProcess, folder: Path) -> MemberSummary:
    """Return what became of a vehicle, by the summary that its process left, or how that ended."""
    name, mission = it.member.name, it.member.mission.name
    path = folder / name / "summary.json"
    if path.is_file():
        found = Summary.model_validate_json(path.read_text(encoding="utf-8"))
        return MemberSummary(
            vehicle=name, mission=mission, outcome=found.outcome, reason=found.reason
        )
    return MemberSummary(vehicle=name, mission=mission, outcome="lost", reason=_why(it, folder))


def _why(it: FleetProcess, folder: Path) -> str:
    code = it.process.wait()
    if code < 0:
        return f"its process died, signal {signal.Signals(-code).name}"
    log = folder / f"{it.member.name}.log"
    said = log.read_text(encoding="utf-8", errors="replace").strip().splitlines()
    return said[-1] if said else f"its process ended with exit code {code}"
