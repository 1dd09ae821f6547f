from __future__ import annotations

import json
import signal
import socket
import subprocess
import sys
from collections.abc import Iterator
from contextlib import closing, contextmanager, suppress
from typing import Any

import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink
from typer.testing import CliRunner

from missionkit.cli.app import app
from missionkit.errors import UsageError, VehicleError
from missionkit.sitl.sitl_server import Server, Setup, serving

LOCAL = "127.0.0.1"
PATIENCE = 10.0  # s, of the wall: only a broken server needs that long


class Remote:
    """A station on a real socket."""

    def __init__(self, sock: socket.socket) -> None:
        self.seen: list[Any] = []
        self._socket = sock
        self._mav = mavlink.MAVLink(None, 245, 190)

    def hear(self, kind: str) -> Any:
        """Return the next message of that kind."""
        while True:
            for n, message in enumerate(self.seen):
                if message.get_type() == kind:
                    del self.seen[: n + 1]
                    return message
            self.seen = self._mav.parse_buffer(self._socket.recv(65536)) or []

    def send(self, message: Any) -> None:
        data = message.pack(self._mav)
        self._socket.sendall(data)

    def command(self, number: int, *params: float) -> int:
        padded = (*params, *(0.0,) * (7 - len(params)))
        self.send(mavlink.MAVLink_command_long_message(1, 1, number, 0, *padded))
        return int(self.hear("COMMAND_ACK").result)


class Asked:
    """The control socket."""

    def __init__(self, port: int) -> None:
        self._socket = socket.create_connection((LOCAL, port), timeout=PATIENCE)
        self._file = self._socket.makefile("rw")

    def __call__(self, **request: Any) -> Any:
        self._file.write(json.dumps(request) + "\n")
        self._file.flush()
        return json.loads(self._file.readline())

    def close(self) -> None:
        self._file.close()
        self._socket.close()


@contextmanager
def udp() -> Iterator[tuple[socket.socket, int]]:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        sock.settimeout(PATIENCE)
        sock.bind((LOCAL, 0))
        yield sock, sock.getsockname()[1]


def test_it_sends_first_on_an_outgoing_udp_link() -> None:
    with udp() as (sock, port):
        setup = Setup(links=(f"udpout:{LOCAL}:{port}",), speed=10.0)
        with serving(setup) as server, closing(Asked(server.control_port)) as ask:
            data, peer = sock.recvfrom(65536)
            assert data[0] == mavlink.PROTOCOL_MARKER_V2
            sock.connect(peer)
            remote = Remote(sock)
            assert remote.command(512, 148) == 0
            assert remote.hear("LOCAL_POSITION_NED").time_boot_ms > 0
            while ask(time=True)["time"] < 1.6:
                remote.hear("ATTITUDE")
            assert remote.command(400, 1) == 0
            assert ask(truth=True)["armed"]


@pytest.mark.parametrize("link", ["udpin:127.0.0.1:0", "udpin://127.0.0.1:0"])
def test_it_waits_for_a_peer_on_an_incoming_udp_link(link: str) -> None:
    with serving(Setup(links=(link,), speed=10.0)) as server, udp() as (sock, _):
        sock.connect(server.addresses[0])
        remote = Remote(sock)
        assert remote.command(512, 148) == 0
        assert remote.hear("ATTITUDE").get_srcSystem() == 1


def test_several_peers_share_a_tcp_port_and_may_leave() -> None:
    with serving(Setup(links=("tcpin:127.0.0.1:0",), dialect="ardupilot", speed=10.0)) as server:
        with (
            socket.create_connection(server.addresses[0], timeout=PATIENCE) as one,
            socket.create_connection(server.addresses[0], timeout=PATIENCE) as two,
        ):
            first, second = Remote(one), Remote(two)
            assert first.command(511, mavlink.MAVLINK_MSG_ID_ATTITUDE, 20_000) == 0
            assert second.hear("HEARTBEAT").autopilot == mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA
            assert first.hear("ATTITUDE").time_boot_ms > 0
        with socket.create_connection(server.addresses[0], timeout=PATIENCE) as again:
            assert Remote(again).hear("HEARTBEAT").autopilot == 3


def test_the_control_socket_answers_and_takes_faults() -> None:
    setup = Setup(links=("udpin:127.0.0.1:0",), speed=10.0)
    with serving(setup) as server, closing(Asked(server.control_port)) as ask:
        truth = ask(truth=True)
        assert truth["position"] == [0.0, 0.0, 0.0]
        assert (truth["mode"], truth["armed"]) == ("LOITER", False)
        fault = ask(fault="gnss_lost+5")
        assert fault["ok"]
        assert fault["at"] <= ask(time=True)["time"]
        assert ask(clear="gnss_lost")["ok"]
        assert ask(parameter="COM_OF_LOSS_T", value=0.4)["value"] == 0.4
        track = ask(track=True, every=2)
        assert len(track["columns"]) == len(track["rows"][0])
        assert ask(journal="command")["notes"] == []
        assert "link_cut" in ask(fault="link_cutt")["error"]
        assert "COM_OF_LOSS_T" in ask(parameter="COM_OF_LOS_T")["error"]
        assert "expected" in ask(what=1)["error"]
        assert ask(quit=True)["ok"]


def test_taken_ports_and_odd_options_are_reported() -> None:
    with socket.create_server((LOCAL, 0)) as taken:
        port = taken.getsockname()[1]
        with pytest.raises(VehicleError, match=f"tcpin:127.0.0.1:{port}"):
            Server(Setup(links=(f"tcpin:{LOCAL}:{port}",)))
        with pytest.raises(VehicleError, match="control"):
            Server(Setup(links=(), control=port))
    for wrong in (
        Setup(links=("udp:14550",)),
        Setup(speed=11.0),
        Setup(speed=0.0),
        Setup(dialect="px5"),
        Setup(faults=("link_cutt",)),
    ):
        with pytest.raises(UsageError):
            Server(wrong)


def test_the_command_prints_its_ports_and_ends_on_request() -> None:
    with udp() as (sock, port):
        command = (sys.executable, "-m", "missionkit", "sitl", "--dialect", "ardupilot")
        options = ("--link", f"udpout:{LOCAL}:{port}", "--speed", "8", "--json")
        with subprocess.Popen((*command, *options), stdout=subprocess.PIPE, text=True) as process:
            assert process.stdout is not None
            ports = json.loads(process.stdout.readline())
            assert ports["links"] == [f"udpout:{LOCAL}:{port}"]
            assert Remote(sock).hear("HEARTBEAT").autopilot == 3
            process.send_signal(signal.SIGINT)
            assert process.wait(PATIENCE) == 0


@pytest.mark.parametrize("home", ["47.4,8.5", "north,8.5,488", "97,8.5,488", "nan,8.5,488"])
def test_an_invalid_home_is_refused(home: str) -> None:
    result = CliRunner().invoke(app, ["sitl", "--home", home])
    assert result.exit_code == 2
    assert "home" in result.stderr


@pytest.mark.parametrize(
    ("line", "says"),
    [
        ("[" * 100_000, "nested too deeply"),
        ('{"truth":' * 5_000, "nested too deeply"),
        ('{"track": true, "every": 1e400}', "cannot convert float infinity to integer"),
        ('{"track": true, "since": [1]}', "must be"),
        ('{"parameter": "COM_OF_LOSS_T", "value": 1e400}', "not a finite number"),
        ("7", "not iterable"),
        ("{", "Expecting"),
    ],
)
def test_nonsense_on_the_control_socket_is_answered_in_a_sentence(line: str, says: str) -> None:
    with serving(Setup(links=("udpin:127.0.0.1:0",), speed=10.0)) as server:
        with (
            socket.create_connection((LOCAL, server.control_port), timeout=PATIENCE) as peer,
            peer.makefile("rw") as file,
        ):
            file.write(line + "\n")
            file.flush()
            assert says in json.loads(file.readline())["error"]
        with closing(Asked(server.control_port)) as ask:
            assert ask(time=True)["time"] >= 0.0


def test_a_line_on_the_control_socket_that_never_ends_is_cut_off() -> None:
    with serving(Setup(links=("udpin:127.0.0.1:0",), speed=10.0)) as server:
        with (
            socket.create_connection((LOCAL, server.control_port), timeout=PATIENCE) as peer,
            suppress(ConnectionError),
        ):
            for _ in range(40):
                peer.sendall(b"[" * 65536)
            assert b"does not end" in peer.recv(4096)
        with closing(Asked(server.control_port)) as ask:
            assert ask(time=True)["time"] >= 0.0
