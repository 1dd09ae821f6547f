"""Whether a time-since-boot stamp fits the autopilot's clock as the messages before it showed it.

One packet with an odd stamp moves nothing. Several in a row that agree with each other, and none in
between that fits the old clock, are a new clock: the autopilot has rebooted if it reads less.
Two clocks that both keep ticking, or that a stream's stamps alternate between, are two vehicles.
"""

from __future__ import annotations

from collections import deque
from enum import Enum
from typing import NamedTuple

AHEAD = 0.3  # s, wall, that a stamp may be younger than the least delay seen so far allows
BACKWARDS = 1.0  # s that stamps may run backwards on a link that reorders
DRIFT = 0.02  # s per s by which the autopilot's clock may be slower than ours
SEVERAL = 5  # messages that agree
LATEST, BACK = 40, 16  # stamps of one stream, and how many ran backwards: two vehicles
ODD, SPAN = 20, 5.0  # so many odd stamps in that time (s), the old clock still there: two vehicles


class Stamp(Enum):
    """Result of the check of a timestamp."""

    SOUND = "fits the clock"
    ODD = "does not fit: ignore the message"
    CHANGED = "a new clock, further on"
    REBOOTED = "a new clock, further back"


class _Clock(NamedTuple):
    """Clock on which several messages agree; times are the vehicle's (s)."""

    delay: float  # the least seen between stamp and arrival, plus the clocks' offset
    newest: float  # stamp
    heard: float  # arrival
    agreed: int = 1  # messages

    def fits(self, boot: float, arrived: float, ahead: float) -> bool:
        least = self.delay - DRIFT * (arrived - self.heard) - ahead
        return arrived - boot >= least and boot >= self.newest - BACKWARDS

    def heard_again(self, boot: float, arrived: float) -> _Clock:
        allowed = self.delay + DRIFT * (arrived - self.heard)
        delay, newest = min(arrived - boot, allowed), max(boot, self.newest)
        return _Clock(delay, newest, arrived, self.agreed + 1)


class BootEpoch:
    """The autopilot's clock, as several messages agree on it.

    Args:
        pace: seconds of the vehicle in one of the wall.
    """

    def __init__(self, pace: float = 1.0) -> None:
        self._pace = pace
        self._ahead = AHEAD * max(1.0, pace)
        self._clock: _Clock | None = None
        self._rival: _Clock | None = None  # odd stamps in a row that agree
        self._odd: deque[float] = deque(maxlen=ODD)  # arrivals
        self._last: float | None = None  # stamp of the stream whose order counts
        self._backwards: deque[bool] = deque(maxlen=LATEST)

    def judge(self, boot: float, arrived: float, *, ordered: bool = False) -> Stamp:
        """Return what a message is worth.

        Args:
            boot: s, its stamp.
            arrived: s, wall, when it came.
            ordered: it is of the stream whose stamps ought to come in order.
        """
        arrived *= self._pace
        if ordered:
            if self._last is not None:
                self._backwards.append(boot < self._last)
            self._last = boot
        if self._clock is None:
            self._clock = _Clock(arrived - boot, boot, arrived)
            return Stamp.SOUND
        if self._clock.fits(boot, arrived, self._ahead):
            self._clock, self._rival = self._clock.heard_again(boot, arrived), None
            if self._odd and arrived - self._odd[-1] > SPAN * max(1.0, self._pace):
                self._odd.clear()  # the other one has gone
            return Stamp.SOUND
        rival = self._rival
        if rival is None or not rival.fits(boot, arrived, self._ahead):
            self._rival = _Clock(arrived - boot, boot, arrived)
        else:
            self._rival = rival.heard_again(boot, arrived)
        self._odd.append(arrived)
        if self._rival.agreed < SEVERAL:
            return Stamp.ODD
        back = self._rival.newest < self._clock.newest - BACKWARDS
        self._clock, self._rival = self._rival, None
        return Stamp.REBOOTED if back else Stamp.CHANGED

    @property
    def contested(self) -> bool:
        """Whether two clocks answer at once: two vehicles with one system id."""
        odd = self._odd
        if sum(self._backwards) >= BACK:  # clocks too close for a stamp to look odd
            return True
        return len(odd) == ODD and odd[-1] - odd[0] <= SPAN * max(1.0, self._pace)
