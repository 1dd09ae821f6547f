"""Addresses of vehicles, as `--vehicle` takes them."""

from __future__ import annotations

import re
from typing import NamedTuple

from missionkit.errors import UsageError, nearest

FORMS = {
    "udpin": "udpin://0.0.0.0:14540",
    "udpout": "udpout://192.168.1.2:14550",
    "tcpin": "tcpin://0.0.0.0:5760",
    "tcpout": "tcpout://192.168.1.2:5760",
    "serial": "serial:///dev/ttyUSB0:57600",
}
_OLD = {"udp": "udpin", "tcp": "tcpout", "serial_flowcontrol": "serial"}
_BAUD = 57600


class Address(NamedTuple):
    """Where a vehicle is listened for or called."""

    scheme: str  # one of FORMS
    place: str  # host, or the serial device
    number: int  # port, or baud rate

    @property
    def url(self) -> str:
        """The address as MAVSDK wants it."""
        return f"{self.scheme}://{self.place}:{self.number}"

    @property
    def key(self) -> str:
        """Resource that two processes must not share: the bound port, the device, or the peer."""
        if self.scheme.endswith("in"):
            return f"{self.scheme[:3]}-{self.number}"
        return re.sub(r"[^A-Za-z0-9]+", "-", f"{self.scheme}-{self.place}-{self.number}")

    @property
    def advice(self) -> tuple[str, ...]:
        """Hints for when no vehicle answers."""
        text = _ADVICE[self.scheme].format(place=self.place, number=self.number)
        return tuple(text.split("; "))


def unopened(address: Address, why: str) -> str:
    """Return what to say about a link that cannot be opened."""
    checks = "".join(f"\n  - {line}" for line in address.advice)
    return f"{address.url} cannot be opened ({why}); check that{checks}"


_ADVICE = {
    "udpin": "the autopilot (or its simulator) sends to port {number} of this machine; "
    "no firewall drops UDP port {number}; no other program holds the port",
    "udpout": "{place}:{number} is the autopilot's own address; "
    "it answers heartbeats that it is sent",
    "tcpin": "the autopilot connects to port {number} of this machine; "
    "no firewall drops TCP port {number}",
    "tcpout": "something listens at {place}:{number}; the autopilot allows another connection",
    "serial": "{place} is the autopilot's device, and you may read it (group dialout); "
    "{number} is the baud rate set on the autopilot; no other program has it open; "
    "MAVLink is enabled on that port of the autopilot",
}


def parse(text: str) -> Address:
    """Return the address that `text` stands for.

    >>> parse("udpin://0.0.0.0:14540")
    Address(scheme='udpin', place='0.0.0.0', number=14540)

    Raises:
        UsageError: it stands for none.
    """
    found = re.fullmatch(r"([a-z_]+)://(.*)", text)
    if found is None:
        raise UsageError(f"vehicle {text!r}: expected {_forms()}")
    scheme, rest = found.groups()
    if scheme in _OLD:
        better = FORMS[_OLD[scheme]]
        raise UsageError(f"vehicle {text!r}: {scheme}:// is ambiguous, write {better}")
    if scheme not in FORMS:
        raise UsageError(f"vehicle {text!r}: unknown kind of link; {nearest(scheme, FORMS)}")
    return _serial(text, rest) if scheme == "serial" else _network(text, scheme, rest)


def _network(text: str, scheme: str, rest: str) -> Address:
    host, colon, port = rest.rpartition(":")
    if not colon or not host or not port.isascii() or not port.isdigit():
        raise UsageError(f"vehicle {text!r}: host and port are missing, as in {FORMS[scheme]}")
    if not 1 <= int(port) <= 65535:
        raise UsageError(f"vehicle {text!r}: a port is between 1 and 65535")
    return Address(scheme, host, int(port))


def _serial(text: str, rest: str) -> Address:
    device, colon, baud = rest.rpartition(":")
    if not colon:
        device, baud = rest, str(_BAUD)
    if not device.startswith("/") or not baud.isascii() or not baud.isdigit() or int(baud) == 0:
        raise UsageError(f"vehicle {text!r}: expected a device and a baud rate, {FORMS['serial']}")
    return Address("serial", device, int(baud))


def _forms() -> str:
    return "an address such as " + ", ".join(FORMS.values())
