"""What detectors share that search at the size which height predicts."""

from __future__ import annotations

import abc
from typing import Final

from pydantic import Field
from typing_extensions import override

from missionkit.ground_robot import GroundRobot
from missionkit.messages import BoxDetection, CameraModel, Frame, Image
from missionkit.perception.apparent_size import SizeGate, size_gate
from missionkit.plugin import BoxDetector
from missionkit.plugin_protocols import Prior
from missionkit.units import Metres, Pixels

ROBOT: Final = GroundRobot()


class SizedDetector(BoxDetector):
    """Finds objects of one size on the ground; where that cannot be seen it finds nothing."""

    object: str = Field(default="robot", description="what it finds, for trackers")
    diameter: Metres = Field(default=ROBOT.diameter, gt=0, description="of an object")
    height: Metres = Field(default=ROBOT.height, ge=0, description="of its top above the ground")
    margin: Pixels = Field(default=4.0, gt=0, description="k, of the size that is searched for")

    @override
    def boxes(self, frame: Frame, camera: CameraModel, prior: Prior) -> tuple[BoxDetection, ...]:
        """Return the boxes around the objects of a frame."""
        gate = size_gate(
            camera, prior.body, prior.ground,
            diameter=self.diameter, top=self.height, margin=self.margin,
        )  # fmt: skip
        spans = None if gate is None else gate.spans(camera)
        if gate is None or spans is None or frame.image is None:
            return ()
        return self.search(frame.image, camera, gate, spans)

    @abc.abstractmethod
    def search(
        self, image: Image, camera: CameraModel, gate: SizeGate, spans: tuple[float, float]
    ) -> tuple[BoxDetection, ...]:
        """Return the boxes around the objects in an image.

        Args:
            image: (height, width) grey or (height, width, 3) BGR.
            camera: lens and mount.
            gate: the expected width by pixel.
            spans: px, the least and the largest width.
        """
