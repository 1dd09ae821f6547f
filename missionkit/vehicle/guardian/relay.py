"""Frames between the autopilot and the mission, looked at on the way; the policy decides.

Sent on untouched, but for streams that the mission does without, and for what it may not say once
the vehicle is ordered to hold.
"""

from __future__ import annotations

import socket
import time
from collections.abc import Callable
from contextlib import suppress
from typing import NamedTuple

from missionkit.vehicle.autopilot_dialect import (
    AUTOPILOT_COMPONENT,
    CMD_ARM,
    CMD_SET_MODE,
    DIALECTS,
    Dialect,
    word,
)
from missionkit.vehicle.guardian import mavlink_frames, policy
from missionkit.vehicle.guardian.autopilot_link import AutopilotLink, Poller
from missionkit.vehicle.guardian.mavlink_frames import ident_of
from missionkit.vehicle.guardian.policy import GuardianPhase, GuardianState, Patience

ORDER_COMMANDS = frozenset((20, 21, 22, 34, 84, 85, CMD_SET_MODE, 192, 193, 300))
DATAGRAM = 2000  # bytes; MAVSDK reads no more than 2048 at once
STILLS = 0.1  # s (of the vehicle) between two setpoints of zero velocity
ASKED = 0.3  # s between two requests for a mode
LONGEST_POLL = 0.2  # s, of the wall, at most between two looks
TENDED = 1.0  # s, of the wall, between two attempts to connect again
UPWARDS = frozenset(
    (
        *mavlink_frames.SETPOINTS,
        mavlink_frames.COMMAND_LONG,
        mavlink_frames.COMMAND_INT,
        mavlink_frames.SET_MODE_MESSAGE,
    )
)
ANSWERED_MESSAGES = frozenset((mavlink_frames.HEARTBEAT,))
HEARD_HOLDING = frozenset((mavlink_frames.HEARTBEAT, mavlink_frames.LOCAL_POSITION))
OFFBOARD_COMMAND = (CMD_SET_MODE, 6.0)
"""With PX4's main mode: setpoints continue, so it announces no silence."""


class Ends(NamedTuple):
    """Where the mission is."""

    local: socket.socket  # its frames
    control: socket.socket  # a word each: idle, given; port, failed, held


class Relay:
    """Carries frames both ways, and steps in when the mission falls silent.

    Args:
        poller: waits for all files.
        ends: of the mission.
        pace: seconds of the vehicle in one of the wall.
        patience: how long silence may last.
        spare: message ids of the autopilot's that the mission does without.
        alone: called when the mission's process is gone.
    """

    def __init__(
        self,
        poller: Poller,
        ends: Ends,
        pace: float,
        patience: Patience,
        spare: frozenset[int],
        alone: Callable[[], None],
    ) -> None:
        self.link: AutopilotLink | None = None
        self.guard = GuardianState()
        self._poller = poller
        self._ends = ends
        self._pace = pace
        self._patience = patience
        self._spare = spare
        self._alone = alone
        self._to: mavlink_frames.FrameRoute | None = None  # the vehicle that we would have to stop
        self._dialects: dict[int, Dialect] = {}  # of each system that sends
        self._sequence = self._again = 0
        self._stilled = self._asked = self._tended = policy.NEVER_YET
        self._met = False
        poller.add(ends.local.fileno(), self._upwards, urgent=True)
        poller.add(ends.control.fileno(), self._told, urgent=True)

    def run(self) -> None:
        """Carry on until there is nothing left to guard."""
        while not self.guard.over:
            self._poller.wait(
                min(LONGEST_POLL, 0.5 * STILLS / self._pace) if self._alert else LONGEST_POLL
            )
            self._act()

    @property
    def now(self) -> float:
        """Time (s) that passes as fast as the vehicle's."""
        return time.perf_counter() * self._pace

    def downwards(self, found: list[bytes]) -> None:
        """Take frames of the autopilot."""
        bundle: list[bytes] = []
        size, spare = 0, self._spare
        watched = HEARD_HOLDING if self.guard.phase is GuardianPhase.HOLDING else ANSWERED_MESSAGES
        for frame in found:
            ident = ident_of(frame)
            if ident in spare:
                continue
            if ident in watched:
                self._hear(frame)
            size += len(frame)
            if size > DATAGRAM and bundle:
                self._pass(bundle)
                size, bundle = len(frame), []
            bundle.append(frame)
        if bundle:
            self._pass(bundle)

    def _pass(self, bundle: list[bytes]) -> None:
        if self._met:
            with suppress(OSError):  # no receiver, or it does not read: the control end reports it
                self._ends.local.send(bundle[0] if len(bundle) == 1 else b"".join(bundle))

    def _hear(self, frame: bytes) -> None:
        received = mavlink_frames.read(frame)
        if received is None or received.component != AUTOPILOT_COMPONENT:
            return
        if received.ident == mavlink_frames.HEARTBEAT:
            self._hear_beat(received)
        elif self._to is not None and received.system == self._to.target and not self._by_mode:
            self._move(policy.moves(self.guard, self.now, mavlink_frames.speed(received)))

    def _hear_beat(self, received: mavlink_frames.MavlinkFrame) -> None:
        beat = mavlink_frames.beat(received)
        dialect = DIALECTS.get(beat.autopilot)
        if dialect is None:
            return
        self._dialects[received.system] = dialect
        if self._to is None or received.system == self._to.target:
            ours = beat.armed and word(dialect, beat.mode) == dialect.offboard_word
            self._move(policy.heard(self.guard, ours=ours))

    def _upwards(self, _: int) -> None:
        while True:
            try:
                data, peer = self._ends.local.recvfrom(65536)
            except OSError:  # nothing more, or an earlier datagram was refused
                return
            if not self._met:
                self._ends.local.connect(peer)
                self._met = True
            allowed = [frame for frame in mavlink_frames.split(data)[0] if self._may(frame)]
            if allowed and self.link is not None:
                self.link.write(b"".join(allowed))

    def _may(self, frame: bytes) -> bool:
        """Look at a frame of the mission; say whether it may pass."""
        if ident_of(frame) not in UPWARDS:
            return True
        received = mavlink_frames.read(frame)
        if received is None:
            return False  # damaged
        if received.ident in mavlink_frames.SETPOINTS:
            self._to = mavlink_frames.FrameRoute(
                received.system, received.component, *mavlink_frames.target(received)
            )
            self._move(policy.setpoint(self.guard, self.now))
            return not self.guard.refuses
        return self._may_order(received)

    def _may_order(self, received: mavlink_frames.MavlinkFrame) -> bool:
        if received.ident == mavlink_frames.SET_MODE_MESSAGE:
            command, first, second = CMD_SET_MODE, 0.0, 0.0
        else:
            command, first, second = mavlink_frames.order(received)
        if command in ORDER_COMMANDS and not (
            self._by_mode and (command, second) == OFFBOARD_COMMAND
        ):
            self._move(policy.silent(self.guard))
        held = command in ORDER_COMMANDS or (command == CMD_ARM and first == 1.0)
        return not (held and self.guard.refuses)

    def _told(self, _: int) -> None:
        self._upwards(0)  # what was sent before comes before
        try:
            received = self._ends.control.recv(64)
        except BlockingIOError:
            return
        except OSError:
            received = b""
        if received == b"idle":
            self._move(policy.silent(self.guard))
        elif received == b"given":
            self._move(policy.given(self.guard))
        elif not received:
            self._poller.remove(self._ends.control.fileno())
            self._alone()
            self._move(policy.gone(self.guard, self.now))

    def _move(self, guard: GuardianState) -> None:
        before, self.guard = self.guard, guard
        if guard.phase is GuardianPhase.HOLDING and before.phase is not GuardianPhase.HOLDING:
            self._again = 0
            if self.link is not None:
                self.link.drop()  # what waits there is older than this
            with suppress(OSError):
                self._ends.control.send(b"held")

    @property
    def _alert(self) -> bool:
        return self.guard.phase in {
            GuardianPhase.STEERED,
            GuardianPhase.BRAKING,
            GuardianPhase.HOLDING,
        }

    @property
    def _by_mode(self) -> bool:
        """Whether there is a mode for holding, apart from the one that follows setpoints."""
        dialect = self._dialect
        return dialect is not None and dialect.hold_word != dialect.offboard_word

    @property
    def _dialect(self) -> Dialect | None:
        if self._to is not None:
            return self._dialects.get(self._to.target)
        return next(iter(self._dialects.values()), None)

    def _act(self) -> None:
        now = self.now
        self._move(policy.waited(self.guard, now, self._patience))
        if self.guard.brakes:
            self._stop(now)
        if now - self._tended > TENDED * self._pace and self.link is not None:
            self._tended = now
            self.link.maintain()

    def _stop(self, now: float) -> None:
        to, dialect = self._to, self._dialect
        if to is None or self.link is None:
            return
        if now - self._stilled >= STILLS:
            self._stilled = now
            self._sequence += 1
            self.link.write(
                mavlink_frames.still(to, self._sequence, int(1e3 * time.perf_counter()))
            )
        if self._by_mode and self.guard.asks and now - self._asked >= ASKED and dialect:
            self._asked = now
            self._sequence += 1
            self.link.write(mavlink_frames.mode(to, self._sequence, dialect.hold, self._again))
            self._again += 1
