"""Orders to devices of the payload: sent one after the other, each until it is acknowledged."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import Final

from missionkit.messages import Device, DeviceOrder
from missionkit.vehicle.command.command_transaction import RESULTS, Acks, send_command
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.link.message_link import MessageLink

IMAGE_START_CAPTURE, DIGICAM_CONTROL = 2000, 203  # MAV_CMD
SET_RELAY, SET_SERVO, GRIPPER = 181, 183, 211
REPEAT_AFTER: Final = 0.3  # s (of the vehicle)
ATTEMPTS: Final = 4
MOST_WAITING: Final = 50
UNSUPPORTED: Final = 3  # MAV_RESULT
REFUSED = "device_refused"


class DeviceQueue:
    """Gives orders to the devices.

    A photo is asked for by the camera protocol, version 2, and by DO_DIGICAM_CONTROL from then on
    where the autopilot does not support that. What is refused, or not answered four times, is
    reported and not tried again: whether it happened is not known.

    Args:
        wire: the link.
        cache: the newest messages.
        remark: takes a sentence for the record.
        note: takes the event.
        pace: seconds of the vehicle in one of the wall.
    """

    def __init__(
        self,
        wire: MessageLink,
        cache: Cache,
        remark: Callable[[str], None],
        note: Callable[[str], None],
        pace: float = 1.0,
    ) -> None:
        self._wire = wire
        self._cache = cache
        self._acks = Acks(cache)
        self._remark = remark
        self._note = note
        self._again = REPEAT_AFTER / pace
        self._waiting: deque[DeviceOrder] = deque()
        self._asked = float("-inf")  # s, wall, when the first one was first sent
        self._sent = float("-inf")  # s, wall
        self._attempts = 0
        self._old_camera = False

    def want(self, orders: Sequence[DeviceOrder]) -> None:
        """Take over the orders of a tick, and carry on with those that wait; never blocks."""
        for order in orders:
            if len(self._waiting) < MOST_WAITING:
                self._waiting.append(order)
            else:
                self._fail(order, "too many orders wait for an answer")
        while self._waiting and self._ended(self._waiting[0]):
            self._next()
        if self._waiting:
            self._send(self._waiting[0])

    def drop(self) -> None:
        """Forget what waits: missionkit no longer commands."""
        self._waiting.clear()
        self._attempts = 0

    def _next(self) -> None:
        self._waiting.popleft()
        self._attempts = 0

    def _ended(self, order: DeviceOrder) -> bool:
        """Say whether there is an answer, or none will come."""
        if not self._attempts:
            return False
        heard = self._acks.since(self._command(order), self._asked)
        if heard is not None and heard[0] == UNSUPPORTED and self._falls_back(order):
            return False
        if heard is not None and heard[0] != 0:
            self._fail(order, RESULTS.get(heard[0], f"result {heard[0]}"))
        late = self._attempts >= ATTEMPTS and self._cache.wall() - self._sent >= self._again
        if heard is None and late:
            self._fail(order, "no answer")
        return heard is not None or late

    def _falls_back(self, order: DeviceOrder) -> bool:
        if order.device is not Device.CAMERA or self._old_camera:
            return False
        self._old_camera, self._attempts = True, 0
        return True

    def _fail(self, order: DeviceOrder, why: str) -> None:
        self._remark(f"{order.device} {order.number}: {why}")
        self._note(REFUSED)

    def _command(self, order: DeviceOrder) -> int:
        if order.device is Device.CAMERA:
            return DIGICAM_CONTROL if self._old_camera else IMAGE_START_CAPTURE
        return {Device.SERVO: SET_SERVO, Device.RELAY: SET_RELAY, Device.GRIPPER: GRIPPER}[
            order.device
        ]

    def _params(self, order: DeviceOrder) -> tuple[float, ...]:
        if order.device is Device.CAMERA:
            photo = (0.0, 0.0, 0.0, 0.0, 1.0) if self._old_camera else (0.0, 0.0, 1.0, order.value)
            return tuple(photo)
        first = order.number - 1 if order.device is Device.RELAY else order.number
        return float(first), order.value

    def _send(self, order: DeviceOrder) -> None:
        now = self._cache.wall()
        if self._attempts and now - self._sent < self._again:
            return
        if not self._attempts:
            self._asked = now
        with suppress(RuntimeError):  # no link: sent again
            send_command(self._wire, self._command(order), self._params(order), self._attempts)
        self._attempts += 1
        self._sent = now
