"""Every kind of address reaches the autopilot."""

import asyncio
import os
import select
import socket
import threading
import tty
from contextlib import contextmanager, suppress

import pytest
from vehicle.flying import SPEED, Sitl, affordable, flying, free_port

from missionkit.sitl.sitl_server import Setup, serving


@contextmanager
def udpin():
    port = free_port()
    with serving(Setup(links=(f"udpout:127.0.0.1:{port}",), speed=affordable(SPEED))) as server:
        yield server, f"udpin://127.0.0.1:{port}"


@contextmanager
def udpout():
    with serving(Setup(links=("udpin:127.0.0.1:0",), speed=affordable(SPEED))) as server:
        yield server, f"udpout://127.0.0.1:{server.addresses[0][1]}"


@contextmanager
def tcpout():
    with serving(Setup(links=("tcpin:127.0.0.1:0",), speed=affordable(SPEED))) as server:
        yield server, f"tcpout://127.0.0.1:{server.addresses[0][1]}"


@contextmanager
def tcpin():
    """Call missionkit from the autopilot's side, as soon as it listens."""
    port, ended = free_port(), threading.Event()
    with udpout() as (server, _), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
        wire.connect(server.addresses[0])
        thread = threading.Thread(target=_call, args=(port, wire, ended), daemon=True)
        thread.start()
        try:
            yield server, f"tcpin://127.0.0.1:{port}"
        finally:
            ended.set()
            thread.join(2.0)


def _call(port, wire, ended):
    while not ended.is_set():
        try:
            line = socket.create_connection(("127.0.0.1", port))
        except OSError:
            ended.wait(0.02)
        else:
            with line, suppress(OSError):  # a reset: it has been let go of
                _carry(line.fileno(), wire, ended)


@contextmanager
def serial():
    """Join a pseudo terminal to the autopilot's datagrams."""
    ours, theirs = os.openpty()
    tty.setraw(ours)
    tty.setraw(theirs)
    ended = threading.Event()
    with udpout() as (server, _), socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as wire:
        wire.connect(server.addresses[0])
        thread = threading.Thread(target=_carry, args=(ours, wire, ended), daemon=True)
        thread.start()
        try:
            yield server, f"serial://{os.ttyname(theirs)}:57600"
        finally:
            ended.set()
            thread.join(2.0)
            os.close(ours)
            os.close(theirs)


def _carry(terminal, wire, ended):
    while not ended.is_set():
        for end in select.select([terminal, wire], [], [], 0.02)[0]:
            if end is wire:
                os.write(terminal, wire.recv(4096))
            elif data := os.read(terminal, 4096):
                wire.send(data)
            else:
                return


@pytest.mark.parametrize("link", [udpin, udpout, tcpin, tcpout, serial])
def test_it_arms_over_every_kind_of_link(link, tmp_path):
    async def arm(autopilot):
        async with flying(autopilot, tmp_path) as flight:
            await flight.arm()
            return flight

    with link() as (server, url):
        autopilot = Sitl(server, 0, server.speed)
        autopilot.url = url
        try:
            flight = asyncio.run(arm(autopilot))
            assert autopilot.truth["armed"]
        finally:
            autopilot.close()
    assert len(flight.vehicle.reports) <= 1
