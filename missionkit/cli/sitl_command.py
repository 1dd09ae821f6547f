"""`missionkit sitl`: a simulated autopilot on MAVLink."""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
from pathlib import Path
from typing import NamedTuple

from pydantic import ValidationError

from missionkit.errors import ExitCode, UsageError
from missionkit.sim.airframes import flown_with
from missionkit.sim.warm_up import warm_up
from missionkit.sim.world import World
from missionkit.sim.world_files import load_multicopter_world
from missionkit.sitl.geodetic import GeographicPoint
from missionkit.sitl.sitl_server import LINKS, Server, Setup


class SitlOptions(NamedTuple):
    """The options of the command."""

    world: Path | None
    dialect: str
    links: tuple[str, ...]
    control: int
    speed: float
    seed: int
    faults: tuple[str, ...]
    home: str
    airframe: str
    as_json: bool
    system: int = 1
    parameters: tuple[str, ...] = ()
    tied: bool = False  # ends when standard input closes
    start: str = ""  # NORTH,EAST


def sitl(wanted: SitlOptions) -> ExitCode:
    """Simulate until interrupted, or ordered to quit over the control socket.

    Raises:
        FileError: the world file cannot be used.
        UsageError: an option does not fit.
        VehicleError: a port is taken.
    """
    path = wanted.world
    world = World(world="empty") if path is None else load_multicopter_world(path)
    if wanted.start:
        world = _started(world, wanted.start)
    setup = Setup(
        flown_with(world, wanted.airframe),
        wanted.dialect,
        wanted.links or LINKS,
        wanted.control,
        wanted.speed,
        wanted.seed,
        wanted.faults,
        _spot(wanted.home),
        wanted.system,
        dict(_parameter(text) for text in wanted.parameters),
    )
    stop = threading.Event()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: stop.set())
    if wanted.tied:
        threading.Thread(target=_until_closed, args=(stop,), name="tie", daemon=True).start()
    server = Server(setup)
    warm_up(corners=False)
    try:
        _tell(server, setup, as_json=wanted.as_json)
        server.run(stop)
    finally:
        server.close()
    return ExitCode.SUCCESS


def _started(world: World, text: str) -> World:
    try:
        north, east = map(float, text.split(","))
        return world.with_start((north, east))
    except ValidationError as error:
        raise UsageError(f"start {text!r}: {error.errors()[0]['msg']}") from error
    except ValueError as error:
        raise UsageError(f"start {text!r}: expected NORTH,EAST") from error


def _until_closed(stop: threading.Event) -> None:
    """Stop when whoever started this has ended, however it did."""
    while os.read(sys.stdin.fileno(), 1024):
        pass
    stop.set()


def _parameter(text: str) -> tuple[str, float]:
    name, _, value = text.partition("=")
    try:
        return name, float(value)
    except ValueError as error:
        raise UsageError(f"parameter {text!r}: expected NAME=NUMBER") from error


def _spot(text: str) -> GeographicPoint:
    try:
        latitude, longitude, height = map(float, text.split(","))
    except ValueError as error:
        raise UsageError(f"home {text!r}: expected LATITUDE,LONGITUDE,HEIGHT") from error
    if not (abs(latitude) < 85.0 and abs(longitude) <= 180.0 and abs(height) < 1e4):
        raise UsageError(f"home {text!r}: not a valid place")
    return GeographicPoint(latitude, longitude, height)


def _tell(server: Server, setup: Setup, *, as_json: bool) -> None:
    """Say, in one line each, where it can be reached."""
    kinds = [text.partition(":")[0] for text in setup.links]
    links = [
        f"{kind}:{host}:{port}" for kind, (host, port) in zip(kinds, server.addresses, strict=True)
    ]
    if as_json:
        ports = {"links": links, "control": server.control_port, "dialect": setup.dialect}
        print(json.dumps(ports), flush=True)  # noqa: T201
        return
    print(  # noqa: T201
        f"{setup.dialect} autopilot in world {setup.world.world!r}, {setup.speed:g} times real time"
        f"\nlinks    {' '.join(links)}\ncontrol  127.0.0.1:{server.control_port}",
        flush=True,
    )
