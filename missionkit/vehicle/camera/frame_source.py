"""Where frames come from in a real flight: a device, or a painter that draws what the pose sees.

Each has its own thread. The latest frame wins; a tick never waits for a camera.
"""

from __future__ import annotations

import abc
import threading
from collections import deque
from collections.abc import Callable
from typing import Protocol

from typing_extensions import override

from missionkit.messages import Frame
from missionkit.vehicle.telemetry.reported_pose import Pose

FRAMES_KEPT = 8  # frames that wait to be taken
Painter = Callable[[Pose, float], Frame]  # pose and time (s, mission) -> what the camera sees


class CameraCarrier(Protocol):
    """Interface of the vehicle for its camera."""

    def pose(self) -> Pose | None:
        """Return where the vehicle is, None while that is not known."""

    def mission_time(self, wall_time: float) -> float | None:
        """Return the mission time (s) at a wall time, None before the first tick."""

    def note(self, event: str) -> None:
        """Keep an event for the mission."""


class FrameSource(Protocol):
    """Gives frames."""

    @property
    def running(self) -> bool:
        """Whether it was started."""

    @property
    def problem(self) -> str:
        """Current problem, "" if there is none."""

    def start(self, around: CameraCarrier) -> None:
        """Begin."""

    def latest(self, now: float) -> Frame | None:
        """Return the newest frame taken by mission time `now` (s) that has not been returned."""

    def stop(self) -> None:
        """End."""


class NoCamera:
    """There is no camera."""

    running = True
    problem = ""

    def start(self, around: CameraCarrier) -> None:
        """Do nothing."""

    def latest(self, now: float) -> Frame | None:  # noqa: ARG002 - as the port asks
        """Return nothing."""
        return None

    def stop(self) -> None:
        """Do nothing."""


class ThreadedCamera(abc.ABC):
    """A camera with a thread of its own, which calls `work` until it has ended."""

    def __init__(self) -> None:
        self.problem = ""  # what is wrong with it now
        self._frames: deque[Frame] = deque(maxlen=FRAMES_KEPT)
        self._lock = threading.Lock()
        self._ended = threading.Event()
        self._thread: threading.Thread | None = None

    @property
    def running(self) -> bool:
        """Whether it was started."""
        return self._thread is not None

    def start(self, around: CameraCarrier) -> None:
        """Begin to look."""
        self._ended.clear()
        self._thread = threading.Thread(
            target=self.work, args=(around,), name="camera", daemon=True
        )
        self._thread.start()

    def latest(self, now: float) -> Frame | None:
        """Return the newest frame taken by `now` (s) that has not been returned; older are lost."""
        frame: Frame | None = None
        with self._lock:
            while self._frames and self._frames[0].at <= now:
                frame = self._frames.popleft()
        return frame

    def stop(self) -> None:
        """End the thread."""
        self._ended.set()
        thread, self._thread = self._thread, None
        if thread is not None:
            thread.join(2.0)

    @abc.abstractmethod
    def work(self, around: CameraCarrier) -> None:
        """Look until `ended`."""

    def give(self, frame: Frame) -> None:
        """Offer a frame; the oldest frames not taken are dropped."""
        with self._lock:
            self._frames.append(frame)

    def ended(self, wait: float) -> bool:
        """Wait (s), and say whether it is time to end."""
        return self._ended.wait(wait)


class Rendered(ThreadedCamera):
    """Draws the world from the pose that the vehicle reports.

    Args:
        painter: draws; the command line brings it.
        rate: frames a second, of mission time.
        pace: seconds of the vehicle in one of the wall.
    """

    def __init__(self, painter: Painter, rate: float, pace: float = 1.0) -> None:
        super().__init__()
        self._painter = painter
        self._period = 1.0 / rate
        self._look = 0.1 / (rate * pace)  # s, wall, between two looks at the pose

    @override
    def work(self, around: CameraCarrier) -> None:
        last = float("-inf")
        while not self.ended(self._look):
            seen = around.pose()
            if seen is None or 0.0 <= seen.at - last < 0.9 * self._period:
                continue
            last = seen.at
            self.give(self._painter(seen, seen.at)._replace(at=seen.at))
