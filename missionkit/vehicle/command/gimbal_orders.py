"""What the gimbal is to be turned to: sent when it changes, until it is acknowledged.

MAVLink's gimbal protocol, version 2: https://mavlink.io/en/services/gimbal_v2.html
"""

from __future__ import annotations

import math
from collections.abc import Callable
from contextlib import suppress
from typing import Final

from missionkit.messages import GimbalAngles
from missionkit.vehicle.command.command_transaction import RESULTS, Acks, send_command
from missionkit.vehicle.command.device_orders import ATTEMPTS, REFUSED, REPEAT_AFTER, UNSUPPORTED
from missionkit.vehicle.link.message_cache import Cache
from missionkit.vehicle.link.message_link import MessageLink

PITCHYAW, CONFIGURE, MOUNT_CONTROL = 1000, 1001, 205  # MAV_CMD_DO_…
FLAGS: Final = 4 | 8 | 32  # GIMBAL_MANAGER_FLAGS: roll and pitch locked, yaw in the vehicle's frame
US: Final = -2.0  # of CONFIGURE: who sends it gets primary control
UNCHANGED: Final = -1.0
TARGETING: Final = 2.0  # MAV_MOUNT_MODE_MAVLINK_TARGETING
LEAST_TURN: Final = math.radians(0.3)
LEAST_GAP: Final = 0.1  # s (of the vehicle) between two orders


class GimbalOrders:
    """Turns the gimbal.

    Primary control is asked for with the first order. Where the autopilot does not support the
    protocol, MAV_CMD_DO_MOUNT_CONTROL is used from then on. A refusal, or silence, is reported
    once, and the next change is tried again.

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
        self._pace = pace
        self._sent: GimbalAngles | None = None
        self._sent_at = -math.inf  # s, wall
        self._attempts = 0  # of the order sent last; 0: it has ended
        self._old = False
        self._reported = False

    def want(self, wanted: GimbalAngles | None) -> None:
        """Turn to these angles; None: stay. Never blocks."""
        if wanted is None:
            return
        self._hear()
        waited = self._silent_for
        if self._sent is None or _apart(self._sent, wanted) > LEAST_TURN:
            if waited >= LEAST_GAP:
                self._send(wanted, attempt=1)
        elif self._attempts and waited >= REPEAT_AFTER:
            self._send(wanted, attempt=self._attempts + 1)

    def drop(self) -> None:
        """Forget the order: missionkit no longer commands, and asks for control when it does."""
        self._sent, self._attempts = None, 0

    @property
    def _command(self) -> int:
        return MOUNT_CONTROL if self._old else PITCHYAW

    def _hear(self) -> None:
        """Take in the answer to the order sent last."""
        if not self._attempts:
            return
        heard = self._acks.since(self._command, self._sent_at)
        if heard is None:
            if self._attempts >= ATTEMPTS and self._silent_for >= REPEAT_AFTER:
                self._end("no answer")
        elif heard[0] == UNSUPPORTED and not self._old:
            self._old, self._sent, self._attempts = True, None, 0
        else:
            self._end("" if heard[0] == 0 else RESULTS.get(heard[0], f"result {heard[0]}"))

    @property
    def _silent_for(self) -> float:
        return (self._cache.wall() - self._sent_at) * self._pace

    def _end(self, wrong: str) -> None:
        self._attempts = 0
        if wrong and not self._reported:
            self._remark(f"gimbal: {wrong}")
            self._note(REFUSED)
        self._reported = bool(wrong)

    def _send(self, wanted: GimbalAngles, attempt: int) -> None:
        if self._sent is None and not self._old:
            self._order(CONFIGURE, (US, US, UNCHANGED, UNCHANGED), attempt)
        self._sent, self._sent_at, self._attempts = wanted, self._cache.wall(), attempt
        pitch, yaw = map(math.degrees, wanted)
        if self._old:
            self._order(MOUNT_CONTROL, (pitch, 0.0, yaw, 0.0, 0.0, 0.0, TARGETING), attempt)
        else:
            self._order(PITCHYAW, (pitch, yaw, None, None, float(FLAGS)), attempt)

    def _order(self, command: int, values: tuple[float | None, ...], attempt: int) -> None:
        with suppress(RuntimeError):  # no link: sent again
            send_command(self._wire, command, values, attempt - 1)


def _apart(a: GimbalAngles, b: GimbalAngles) -> float:
    return max(abs(a.pitch - b.pitch), abs(a.yaw - b.yaw))
