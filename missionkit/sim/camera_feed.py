"""The simulated camera as the vehicle has it: when frames are exposed, and when they arrive."""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from missionkit.camera_pointing import camera_to_body
from missionkit.geometry import Mat, Transform, Vec3
from missionkit.messages import Frame, GimbalAngles
from missionkit.sim.gimbal import SimulatedGimbal
from missionkit.sim.kernel_layout import RATE
from missionkit.sim.marker_visibility import Spotter
from missionkit.sim.robot_boxes import BoxSpotter
from missionkit.sim.robot_look import RobotLook, looks_of
from missionkit.sim.world import World
from missionkit.units import Spot

if TYPE_CHECKING:
    from missionkit.perception.camera_section import Camera
    from missionkit.sim.camera_renderer import Renderer


class Shot(NamedTuple):
    """One exposure that has not arrived yet."""

    at: float  # s
    due: float  # s
    state: Vec3  # (13,) truth, see `kernel_layout`
    hidden: frozenset[int]
    repeat: bool  # frozen: the last frame comes again
    flipped: bool  # upside down
    robots: tuple[RobotLook, ...] = ()
    shift: Spot = (0.0, 0.0)  # m, north and east, by which the deck has driven
    mount: Transform | None = None  # camera to body, of a gimbal
    gimbal: GimbalAngles | None = None  # as it says it was turned


class Feed:
    """Frames of one camera. Pictures are made on arrival, and only those that are delivered.

    Args:
        camera: the mission's.
        world: what there is to see.
        things: (N, 8) obstacles that hide markers.
        rng: the camera's stream.
        boxes: the stream of what detectors of ground robots would find.
    """

    def __init__(
        self,
        camera: Camera,
        world: World,
        things: Mat,
        rng: np.random.Generator,
        boxes: np.random.Generator,
    ) -> None:
        self._camera = camera
        self._world = world
        self._model = camera.model()
        self._spotter = Spotter(
            world.all_markers, self._model, things, rng, len(world.deck_markers)
        )
        self._boxes = BoxSpotter(world, self._model, boxes)
        self._renderer = self._start(world, rng) if camera.drawn else None
        self._waiting: deque[Shot] = deque()
        self._last: Frame | None = None
        self._count = 1
        self._off = camera.use == "none"
        self._any_robots = bool(world.target_starts or world.obstacle_starts)

    def _start(self, world: World, rng: np.random.Generator) -> Renderer:
        from missionkit.sim.camera_renderer import Renderer  # noqa: PLC0415 (imports cv2)

        return Renderer(world, self._model, rng)

    @property
    def next_step(self) -> int:
        """Physics step of the next exposure."""
        if self._off:
            return 1 << 62
        return round(self._count * RATE / self._camera.rate)

    def expose(
        self,
        x: Vec3,
        robots: Mat,
        *,
        hidden: frozenset[int],
        delay: float,
        off: bool,
        frozen: bool,
        flipped: bool,
        gimbal: SimulatedGimbal | None = None,
        gimbal_lost: bool = False,
    ) -> None:
        """Take the exposure that is due now, with the true state `x` and the active faults.

        Args:
            x: (17,) true state.
            robots: (R, ·) true states of the ground robots.
            hidden: ids of markers that are covered.
            delay: s, added to the latency.
            off: no frame.
            frozen: repeat the last frame.
            flipped: upside down.
            gimbal: that turns the camera.
            gimbal_lost: it does not say how it is turned.
        """
        at = self.next_step / RATE
        self._count += 1
        if not off:
            due = at + self._camera.latency + delay
            looks = tuple(looks_of(self._world, robots))
            state, shift = x[:13].copy(), (0.0, 0.0)
            deck = self._world.deck
            if deck is not None and deck.moves:
                shift = deck.shift(at)
                state[3:5] -= deck.velocity_at(at)  # blur is that of the markers on the deck
            shot = Shot(at, due, state, hidden, frozen, flipped, looks, shift)
            if gimbal is not None:
                shot = self._turned(shot, gimbal, lost=gimbal_lost)
            self._waiting.append(shot)

    def _turned(self, shot: Shot, gimbal: SimulatedGimbal, *, lost: bool) -> Shot:
        """Return an exposure through a camera on a gimbal."""
        told, truth = gimbal.measured(shot.at), gimbal.angles(shot.at)
        return shot._replace(
            state=gimbal.turned_state(shot.state, shot.at),
            mount=camera_to_body(self._model, shot.state[6:10], truth),
            gimbal=None if lost else told,
        )

    def deliver(self, now: float) -> Frame | None:
        """Return the newest frame that has arrived by `now` (s), if any; older ones are lost."""
        shot: Shot | None = None
        while self._waiting and self._waiting[0].due <= now + 1e-9:
            shot = self._waiting.popleft()
        if shot is None:
            return None
        if not shot.repeat:
            picture = self._picture(shot)
            self._last = self._upside_down(picture) if shot.flipped else picture
        return self._last

    def _upside_down(self, frame: Frame) -> Frame:
        """Return it turned by half a turn."""
        if frame.image is not None:
            turned = np.ascontiguousarray(frame.image[::-1, ::-1])
            return frame._replace(image=turned)
        last = np.array([self._camera.width - 1.0, self._camera.height - 1.0])
        found = tuple((name, number, last - at) for name, number, at in frame.corners or ())
        boxes = tuple(box._replace(centre=last - box.centre) for box in frame.boxes or ())
        return frame._replace(corners=found, boxes=boxes)

    def _picture(self, shot: Shot) -> Frame:
        x, exposure = shot.state, self._camera.exposure
        body = Transform(x[6:10], x[:3])
        if self._renderer is None:
            corners = self._spotter.find(x, exposure, shot.hidden, shot.shift, shot.mount)
            boxes = self._boxes.find(body, shot.robots, shot.mount) if self._any_robots else ()
            return Frame(shot.at, None, corners, boxes, shot.gimbal)
        moving = x[3:6], x[10:13]
        image = self._renderer.render(
            body, *moving, exposure, shot.hidden, shot.robots, shot.shift, shot.mount
        )
        return Frame(shot.at, image, gimbal=shot.gimbal)
