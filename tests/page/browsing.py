"""A browser for tests: sessions, requests and the live messages of a page's server."""

from __future__ import annotations

import http.client
import json
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from websockets.sync.client import ClientConnection, connect

from missionkit.page.server.binding import Binding, PageAddress, address_of, listening
from missionkit.page.server.page_source import PageSource
from missionkit.page.server.serving import server_of
from missionkit.page.server.sessions import Tokens

TIMEOUT = 30.0  # s


@dataclass
class Browser:
    """One browser that has opened the page."""

    port: int
    cookie: str = ""
    csrf: str = ""
    role: str = ""
    headers: dict[str, str] = field(default_factory=dict)

    @property
    def origin(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    def request(
        self, method: str, path: str, body: Any = None, **headers: str
    ) -> tuple[int, dict[str, str], bytes]:
        """Send a request as a browser does; headers may be replaced, with _ for -."""
        given = {"Cookie": self.cookie, **self.headers}
        if method == "POST":
            given |= {"Origin": self.origin, "X-CSRF": self.csrf}
        given |= {name.replace("_", "-"): value for name, value in headers.items()}
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=TIMEOUT)
        try:
            data = None if body is None else json.dumps(body)
            connection.request(method, path, data, {k: v for k, v in given.items() if v})
            answer = connection.getresponse()
            return answer.status, dict(answer.getheaders()), answer.read()
        finally:
            connection.close()

    def get(self, path: str) -> Any:
        status, _, data = self.request("GET", path)
        assert status == 200, (status, data)
        return json.loads(data)

    def post(self, path: str, body: Any, **headers: str) -> tuple[int, Any]:
        status, _, data = self.request("POST", path, body, **headers)
        return status, json.loads(data)

    def enter(self, token: str | None = None) -> int:
        """Open a session; return the status."""
        status, headers, data = self.request("POST", "/api/session", {"token": token})
        if status == 200:
            self.cookie = headers["set-cookie"].partition(";")[0]
            said = json.loads(data)
            self.csrf, self.role = said["csrf"], said["role"]
        return status

    @contextmanager
    def live(self, **headers: str) -> Iterator[Live]:
        given = {"Cookie": self.cookie, **headers}
        origin = given.pop("Origin", self.origin)
        with connect(
            f"ws://127.0.0.1:{self.port}/api/live",
            origin=origin,
            additional_headers=given,
            compression=None,
            open_timeout=TIMEOUT,
        ) as socket:
            yield Live(socket)


class Live:
    """The messages of one WebSocket, put together."""

    def __init__(self, socket: ClientConnection) -> None:
        self.socket = socket
        self.now: dict[str, Any] = {}
        self.fired: list[dict[str, Any]] = []
        self.kinds: list[str] = []

    def next(self) -> dict[str, Any]:
        return self._take(self.socket.recv(timeout=TIMEOUT))

    def _take(self, text: Any) -> dict[str, Any]:
        message = json.loads(text)
        self.kinds.append(message.pop("t"))
        self.fired += message.pop("fired", [])
        self.now = {**(self.now if self.kinds[-1] == "delta" else {}), **message}
        return self.now

    def catch_up(self) -> None:
        """Read what has arrived already."""
        waiting = True
        while waiting:
            try:
                self._take(self.socket.recv(timeout=0.01))
            except TimeoutError:
                waiting = False

    def until(self, wanted: Any) -> dict[str, Any]:
        """Return the first state that is wanted."""
        for _ in range(2000):
            if self.now and wanted(self.now):
                return self.now
            self.next()
        raise AssertionError(f"not seen; the last was {self.now}")

    def send(self, **message: Any) -> None:
        self.socket.send(json.dumps(message))


@contextmanager
def served(
    source: PageSource,
    tokens: Tokens | None = None,
    port: int = 0,
    tiles: Path | None = None,
) -> Iterator[PageAddress]:
    """Serve a page on this computer, on a free port if none is named."""
    where = Binding(port=port, tiles=tiles)
    with listening(where) as bound:
        server = server_of(source, where, bound, tokens)
        thread = threading.Thread(target=server.run, kwargs={"sockets": [bound]}, daemon=True)
        thread.start()
        try:
            yield address_of(where, bound, tokens)
        finally:
            server.should_exit = True
            thread.join(TIMEOUT)
            assert not thread.is_alive()


def port_of(address: PageAddress) -> int:
    return int(address.url.rstrip("/").rpartition(":")[2])
