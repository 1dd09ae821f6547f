"""The link itself: the only module that speaks to MAVSDK."""

from __future__ import annotations

import asyncio
import ctypes
import json
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from mavsdk import logging as mavsdk_logging
from mavsdk.asyncio import ComponentType, Configuration, Mavsdk
from mavsdk.asyncio.exceptions import MavsdkConnectionError
from mavsdk.asyncio.plugins.mavlink_direct import MavlinkDirectAsync
from mavsdk.exceptions import MavsdkError
from mavsdk.plugins.mavlink_direct import MavlinkDirect, MavlinkMessage
from mavsdk.plugins.mission_raw import MissionItem, MissionRaw
from mavsdk.plugins.param import Param, ParamError

from missionkit.errors import VehicleError
from missionkit.vehicle.link.link_address import Address, unopened
from missionkit.vehicle.link.message_link import PlanItem

LOOK = 0.1  # s between two looks at which systems are there
AUTOPILOT = 1  # MAV_COMP_ID_AUTOPILOT1
SENSORS = frozenset(  # may come from other components of the vehicle, such as a sensor of its own
    (
        "BATTERY_STATUS",
        "DISTANCE_SENSOR",
        "OBSTACLE_DISTANCE",
        "OPTICAL_FLOW",
        "OPTICAL_FLOW_RAD",
    )
)
_STAMPS = ("time_usec", "time_boot_ms")
_TARGETED = frozenset(("COMMAND_LONG", "SET_POSITION_TARGET_LOCAL_NED", "SET_ATTITUDE_TARGET"))

Receiver = Callable[[str, dict[str, Any]], None]


def _hush() -> None:
    """Keep MAVSDK's log from standard output, which belongs to the command line.

    Its hook must not be a Python function: that would run on MAVSDK's I/O thread and stop it
    whenever the interpreter is busy. `isascii` of the C library answers "true" (1: handled) to
    every log level, and touches nothing.
    """
    hook = ctypes.cast(ctypes.CDLL(None).isascii, mavsdk_logging.LogCallback)
    mavsdk_logging._cmavsdk_lib.mavsdk_log_subscribe(hook, None)  # noqa: SLF001


class Link:
    """A connection to one autopilot; messages are mappings from field names to values."""

    def __init__(self, mavsdk: Mavsdk, system: Any, system_id: int) -> None:
        self.system_id = system_id
        self._mavsdk = mavsdk
        # The synchronous object: its send takes 0.2 ms and needs no event loop.
        self._async = MavlinkDirectAsync(system)
        self._direct: MavlinkDirect = self._async._plugin  # noqa: SLF001
        raw = system._system  # noqa: SLF001 - the same for the other plug-ins
        self._param = Param(raw)
        self._mission = MissionRaw(raw)
        self._subscriptions: list[Any] = []

    @classmethod
    async def open(
        cls,
        address: Address,
        patience: float,
        system_id: int | None = None,
        local: Address | None = None,
    ) -> Link:
        """Connect, and wait for the first message of an autopilot.

        Args:
            address: where it is.
            patience: s to wait for it.
            system_id: of the vehicle, where several share the link; None: the first that answers.
            local: where its guardian relays the link; None: there is none.

        Raises:
            VehicleError: the link cannot be opened, or no vehicle answers within `patience` (s).
        """
        _hush()
        setting = Configuration.create_with_component_type(ComponentType.COMPANION_COMPUTER)
        mavsdk = Mavsdk(setting)
        try:
            await mavsdk.add_any_connection((local or address).url)
            system = await mavsdk.first_autopilot(timeout_s=patience)
            if system is not None and system_id is not None:
                system = await _named(mavsdk, system_id, address, patience)
        except MavsdkConnectionError as error:
            mavsdk.destroy()
            raise VehicleError(unopened(address, str(error))) from None
        except BaseException:
            mavsdk.destroy()
            raise
        if system is None:
            mavsdk.destroy()
            raise VehicleError(_unanswered(address, patience))
        return cls(mavsdk, system, await system.get_system_id())

    async def systems(self) -> dict[int, str]:
        """Return what has an autopilot on this link: system id -> such as `PX4 multicopter`."""
        return await _systems(self._mavsdk)

    def listen(self, names: Iterable[str], receive: Receiver) -> None:
        """Call `receive` on MAVSDK's thread with every message of the autopilot of these names.

        Those of SENSORS may come from any component of the vehicle; the stamps of another one's
        clock are taken out.
        """

        def arrived(message: MavlinkMessage, _: object) -> None:
            if message.system_id != self.system_id:
                return
            fields = json.loads(message.fields_json)
            if message.component_id == AUTOPILOT:
                receive(message.message_name, fields)
            elif message.message_name in SENSORS:
                own = {key: value for key, value in fields.items() if key not in _STAMPS}
                receive(message.message_name, {**own, "component": message.component_id})

        for name in names:
            self._subscriptions.append(self._direct.subscribe_message(name, arrived))

    def send(self, name: str, **fields: Any) -> None:
        """Send a message to the autopilot; None stands for NaN.

        Raises:
            RuntimeError: it could not be sent.
        """
        if name in _TARGETED:
            fields = {**fields, "target_system": self.system_id, "target_component": AUTOPILOT}
        text = json.dumps(fields)
        message = MavlinkMessage(name, 0, 0, self.system_id, AUTOPILOT, text)
        try:
            self._direct.send_message(message)
        except MavsdkError as error:
            raise RuntimeError(f"{name} could not be sent: {error}") from None

    def parameter(self, name: str) -> float | None:
        """Return a parameter's value, None if it is not there. Blocks the calling thread."""
        for get in (self._param.get_param_float, self._param.get_param_int):
            try:
                return float(get(name))
            except ParamError as error:
                if error.result.name == "TIMEOUT":
                    return None
        return None

    def set_parameter(self, name: str, value: float) -> bool:
        """Set a parameter, say whether that was confirmed. Blocks the calling thread."""
        for give, number in (
            (self._param.set_param_float, value),
            (self._param.set_param_int, round(value)),
        ):
            try:
                give(name, number)
            except ParamError as error:
                if error.result.name == "TIMEOUT":
                    return False
                continue
            return True
        return False

    def upload_fence(self, items: Sequence[PlanItem]) -> None:
        """Replace the geofence. Blocks the calling thread.

        Raises:
            VehicleError: the autopilot did not accept it.
        """
        self._upload("the geofence", self._mission.upload_geofence, items)

    def upload_rally(self, items: Sequence[PlanItem]) -> None:
        """Replace the rally points. Blocks the calling thread.

        Raises:
            VehicleError: the autopilot did not accept them.
        """
        self._upload("the rally points", self._mission.upload_rally_points, items)

    def download_fence(self) -> tuple[PlanItem, ...]:
        """Return the geofence that the autopilot has. Blocks the calling thread.

        Raises:
            VehicleError: it did not answer.
        """
        return self._download("the geofence", self._mission.download_geofence)

    def download_rally(self) -> tuple[PlanItem, ...]:
        """Return the rally points that the autopilot has. Blocks the calling thread.

        Raises:
            VehicleError: it did not answer.
        """
        return self._download("the rally points", self._mission.download_rallypoints)

    def close(self) -> None:
        """Let go of the link; returns when no callback runs any more."""
        subscriptions, self._subscriptions = self._subscriptions, []
        for subscription in subscriptions:
            self._direct.unsubscribe_message(subscription)
        for plugin in (self._async, self._param, self._mission):
            plugin.destroy()
        self._mavsdk.destroy()

    @staticmethod
    def _upload(what: str, give: Callable[[list[Any]], object], items: Sequence[PlanItem]) -> None:
        try:
            give([MissionItem(**item._asdict()) for item in items])
        except MavsdkError as error:
            raise VehicleError(f"{what} could not be uploaded: {error}") from None

    @staticmethod
    def _download(what: str, get: Callable[[], Sequence[Any]]) -> tuple[PlanItem, ...]:
        try:
            found = get()
        except MavsdkError as error:
            raise VehicleError(f"{what} could not be read back: {error}") from None
        return tuple(PlanItem(*(getattr(one, name) for name in PlanItem._fields)) for one in found)


async def _systems(mavsdk: Mavsdk) -> dict[int, str]:
    found = {}
    for system in await mavsdk.get_systems():
        if await system.has_autopilot():
            autopilot, kind = await system.autopilot_type(), await system.vehicle_type()
            words = f"{autopilot.name} {kind.name}"
            found[await system.get_system_id()] = words.replace("_", " ").lower()
    return found


async def _named(mavsdk: Mavsdk, system_id: int, address: Address, patience: float) -> Any:
    """Wait for the system with that id."""
    for _ in range(round(patience / LOOK)):
        for system in await mavsdk.get_systems():
            if await system.get_system_id() == system_id and await system.has_autopilot():
                return system
        await asyncio.sleep(LOOK)
    there = listed(await _systems(mavsdk))
    raise VehicleError(
        f"{address.url}: no autopilot with system id {system_id} answered within {patience:g} s; "
        f"there is {there}"
    )


def listed(systems: Mapping[int, str]) -> str:
    """Return systems as a list to read: `system 1 (px4 multicopter), system 7 (...)`."""
    return ", ".join(f"system {number} ({kind})" for number, kind in sorted(systems.items()))


def _unanswered(address: Address, patience: float) -> str:
    checks = "".join(f"\n  - {line}" for line in address.advice)
    return (
        f"no autopilot answered at {address.url} within {patience:g} s; check that{checks}\n"
        "  - it is powered and sends heartbeats (component 1)"
    )
