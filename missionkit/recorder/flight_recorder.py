"""The flight record: one MCAP file per run, readable by Foxglove.

Rates follow P1 section 9.2: poses and commands at every tick (20 Hz), goal, state, guards, estimate
and timing at 10 Hz, status at 1 Hz. A transition, a change of a guard's answer, a new problem and
an overrun are written at their own tick whatever the rate. Camera frames come at `image_rate`.
What was recorded is with the operating system 0.05 s later: a kill loses one tick or two.
"""

from __future__ import annotations

from pathlib import Path
from types import TracebackType
from typing import NamedTuple, Self

from missionkit.geodesy import Origin
from missionkit.messages import CameraModel, Frame, Occupancy, Record
from missionkit.recorder import (
    flight_track,
    geographic_messages,
    json_fragments,
    message_encoding,
    photo_log,
)
from missionkit.recorder.flight_track import FlightTrack, Truth
from missionkit.recorder.geographic_messages import Georeference
from missionkit.recorder.mcap_channels import Channels
from missionkit.recorder.problem_log import unsaid
from missionkit.recorder.record_sinks import Job, Sink
from missionkit.recorder.scenery import Scenery, scene_update

LEVEL_INFO, LEVEL_WARNING = 2, 3
FIX_RATE = 2.0  # Hz, of /fix


class RateLimit:
    """Says yes at most `rate` times a second of mission time."""

    def __init__(self, rate: float) -> None:
        self._rate = rate
        self._slot = -1

    def due(self, now: float) -> bool:
        """Say whether the slot of time `now` (s) is still unused, and use it."""
        slot = int(now * self._rate + 1e-6)
        if slot == self._slot:
            return False
        self._slot = slot
        return True


class Seen(NamedTuple):
    """Values of the previous tick; a change triggers a message."""

    state: str = ""
    since: float = 0.0  # s
    answers: tuple[tuple[str, bool | None], ...] = ()
    problems: tuple[str, ...] = ()
    overruns: int = 0


class FlightRecorder:
    """Writes `flight.mcap` into the folder of a run and keeps its track.

    Args:
        folder: exists and holds no flight record yet.
        camera: intrinsics and mount, for the frame tree.
        scenery: what stands around, written once.
        image_rate: camera frames a second at most; 0 keeps none.
        name: of the file; a flight that is resumed gets one for each part.
        past: the track of the parts before.
        known: the mission's map, written once.
        reference: where on the earth and when it flies.
        sink: writes what is recorded; without one that is done at once, and errors are raised.

    Raises:
        FileExistsError: the folder already holds a flight record.
    """

    def __init__(
        self,
        folder: Path,
        *,
        camera: CameraModel | None = None,
        scenery: Scenery | None = None,
        image_rate: float = 5.0,
        name: str = "flight.mcap",
        past: FlightTrack | None = None,
        known: Occupancy | None = None,
        reference: Georeference | None = None,
        sink: Sink | None = None,
    ) -> None:
        self.track: FlightTrack = past or flight_track.begin()
        self._sink = sink
        self._channels = Channels(folder / name)
        self._camera = camera
        self._scenery = scenery
        self._drawn = Scenery() if scenery is None else scenery
        self._known = known
        self._reference = reference
        self._origin: Origin | None = None
        self._fixes = RateLimit(FIX_RATE)
        self._standing, self._status, self._kept = RateLimit(10.0), RateLimit(1.0), RateLimit(20.0)
        self._images = RateLimit(image_rate) if image_rate > 0.0 else None
        self._seen = Seen()
        self._hash = ""
        self._closed = False
        self._photos = folder / "photos.csv"
        self._taken = photo_log.last_number(self._photos)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self.close()

    def write(self, record: Record, frame: Frame | None = None, truth: Truth | None = None) -> None:
        """Record one tick.

        Args:
            record: what the tick decided.
            frame: the camera frame that arrived at this tick.
            truth: where a simulated vehicle really is.
        """
        flight_track.add(self.track, record, truth)
        shown = None if frame is None or frame.image is None else frame
        if shown is not None and not (self._images and self._images.due(record.now)):
            shown = None  # what is not recorded does not wait in memory either
        self._put(lambda: self._tick(record, shown, truth))
        if self._reference is not None:
            self._locate(record, self._reference)
        if record.command.orders:
            self._log_photos(record)

    def _log_photos(self, record: Record) -> None:
        """Write where photos were taken from."""
        reference = self._reference
        origin = None if reference is None else reference.origin()
        began = None if reference is None else reference.date() - record.now
        text = photo_log.rows(record, origin, began, self._taken)
        self._taken += len(text)
        if text:
            self._put(lambda: photo_log.append(self._photos, text))

    def _locate(self, record: Record, reference: Georeference) -> None:
        """Write where on the earth the vehicle is, once it is known where the origin is."""
        origin, at = reference.origin(), json_fragments.nanoseconds(record.now)
        stamp = json_fragments.stamp(record.now)
        if origin is None:
            return
        if origin != self._origin:
            self._origin, began = origin, reference.date() - record.now
            said = geographic_messages.origin(stamp, origin, began)
            shown = geographic_messages.places(origin, self._drawn)
            self._put(lambda: self._channels.publish("/origin", at, said))
            self._put(lambda: self._channels.publish("/places", at, shown))
        if self._fixes.due(record.now) and record.estimate.health.aligned:
            fix = geographic_messages.location(stamp, origin, record.estimate)
            self._put(lambda: self._channels.publish("/fix", at, fix))

    def close(self) -> str:
        """Finish the file and return its digest, "" if that failed; closing twice does no harm."""
        if not self._closed:
            self._closed = True
            self._put(self._finish)
            if self._sink is not None:
                self._sink.close()
        return self._hash

    def _put(self, job: Job) -> None:
        write = self._channels.abandoned_on_error(job)
        if self._sink is None:
            write()
        else:
            self._sink.put(write)

    def _finish(self) -> None:
        self._hash = self._channels.close()

    def _tick(self, record: Record, frame: Frame | None, truth: Truth | None) -> None:
        at, stamp = json_fragments.nanoseconds(record.now), json_fragments.stamp(record.now)
        self._motion(record, truth, at, stamp)
        self._chart(record, at, stamp)
        if self._status.due(record.now):
            self._diagnostics(record, at, stamp)
        if frame is not None:
            self._image(record, frame, at)
        if self._kept.due(record.now):
            self._channels.flush()

    def _motion(self, record: Record, truth: Truth | None, at: int, stamp: str) -> None:
        publish, seen = self._channels.publish, record.estimate
        publish("/pose", at, message_encoding.pose(stamp, seen.position, seen.attitude))
        publish("/command", at, message_encoding.command(stamp, record.command))
        if truth is not None:
            publish("/truth/pose", at, message_encoding.pose(stamp, truth.position, truth.attitude))

    def _chart(self, record: Record, at: int, stamp: str) -> None:
        """Write state, guards, estimate and goal when due or changed, transitions always."""
        publish, before = self._channels.publish, self._seen
        now = self._seen = _summary_of(record, before)
        due = self._standing.due(record.now)
        for fired in record.fired:
            publish("/transitions", at, message_encoding.transition(stamp, fired))
        if due or now.state != before.state or now.problems != before.problems:
            publish("/state", at, message_encoding.state(stamp, record, now.since))
        if record.verdicts and (due or now.answers != before.answers):
            publish("/guards", at, message_encoding.guards(stamp, record))
        if due or now.overruns != before.overruns:
            publish("/timing", at, message_encoding.timing(stamp, record.cycle))
        if due:
            publish("/tf", at, message_encoding.body(stamp, record.estimate, self._camera))
            publish("/estimate", at, message_encoding.estimate(stamp, record.estimate))
            if record.estimate.goal is not None:
                publish("/goal", at, message_encoding.goal(stamp, record.estimate.goal))
        self._log(record, before, at, stamp)

    def _log(self, record: Record, before: Seen, at: int, stamp: str) -> None:
        for action in record.actions:
            said = message_encoding.log(stamp, LEVEL_INFO, action.said())
            self._channels.publish("/log", at, said)
        for fired in record.fired:
            line = f"{fired.source} -> {fired.to}: {fired.reason}"
            self._channels.publish("/log", at, message_encoding.log(stamp, LEVEL_INFO, line))
            for output in fired.outputs:
                self._channels.publish("/log", at, message_encoding.log(stamp, LEVEL_INFO, output))
        if record.problems != before.problems:
            for problem in unsaid(record.problems, before.problems):
                self._channels.publish(
                    "/log", at, message_encoding.log(stamp, LEVEL_WARNING, problem)
                )

    def _diagnostics(self, record: Record, at: int, stamp: str) -> None:
        """Write status, the links that never move, and the scene with the first of them."""
        publish = self._channels.publish
        publish("/status", at, message_encoding.status(stamp, record.estimate))
        publish("/tf", at, message_encoding.fixed_links(stamp, self._camera))
        if self._camera is not None:
            publish("/camera/calibration", at, message_encoding.calibration(stamp, self._camera))
        if self._scenery is not None:
            publish("/scene", at, scene_update(self._scenery, stamp, message_encoding.NED_FRAME))
            self._scenery = None
        if self._known is not None:
            publish("/map", at, geographic_messages.grid(stamp, self._known))
            self._known = None

    def _image(self, record: Record, frame: Frame, at: int) -> None:
        """Write a camera frame and the markers found in it, both at the time of exposure."""
        if frame.image is None:
            return
        from missionkit.perception.opencv_helpers import encode_jpeg  # noqa: PLC0415

        stamp = json_fragments.stamp(frame.at)
        self._channels.publish(
            "/camera/image", at, message_encoding.image(stamp, encode_jpeg(frame.image))
        )
        found = tuple(it for it in record.estimate.sightings if it.at == frame.at)
        self._channels.publish("/camera/markers", at, message_encoding.markers(stamp, found))


def _summary_of(record: Record, before: Seen) -> Seen:
    """Reduce a tick to what the next one is compared with."""
    entered = record.state != before.state or bool(record.fired)
    return Seen(
        record.state,
        record.now if entered else before.since,
        tuple([(name, verdict.holds) for name, verdict in record.verdicts]),
        record.problems,
        record.cycle.overruns,
    )
