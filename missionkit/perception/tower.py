"""Obstacle robots with a bright plate and a tower on it: `perception: [{use: tower}]`."""

from __future__ import annotations

from typing import ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.messages import BoxDetection, CameraModel, Image
from missionkit.messages.robot_modes import OBSTACLE
from missionkit.perception.apparent_size import SizeGate
from missionkit.perception.sized_detector import SizedDetector
from missionkit.units import Metres, Number


class Tower(SizedDetector):
    """Obstacle robots by their plate, brighter than the ground, and the tower that leans off it.

    From above a tower leans away from the point below the camera. So of a bright part of the image
    the end next to that point is the plate; it counts if it is as large as a plate of `diameter`
    appears, filled, and not cut by the edge, however long the part is. A bright spot farther out
    on the same line is the tower's top, not another robot. Colour is not looked at.
    """

    kind: ClassVar[str] = "tower"
    object: str = Field(default=OBSTACLE, description="what it finds, for trackers")
    diameter: Metres = Field(default=0.23, gt=0, description="of the plate")
    contrast: Number = Field(
        default=72.0, gt=0, le=255, description="least, in grey levels, to what is around"
    )

    @override
    def search(
        self, image: Image, camera: CameraModel, gate: SizeGate, spans: tuple[float, float]
    ) -> tuple[BoxDetection, ...]:
        """Return the boxes around the plates in an image."""
        from missionkit.perception import tower_search  # noqa: PLC0415 heavy

        mask = tower_search.bright(image, self.contrast, spans[1])
        found = tower_search.plates(mask, gate, tower_search.below(camera, gate))
        return tuple(
            BoxDetection(
                self.kind, it.centre, (it.width, it.width), it.score, self.object, sized=False
            )
            for it in found
        )
