"""Objects that differ from the ground in colour, or in brightness: `perception: [{use: blob}]`."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Annotated, ClassVar, Final, Literal, NamedTuple

import cv2
import numpy as np
from pydantic import Field
from typing_extensions import override

from missionkit.messages import BoxDetection, CameraModel, Frame, Image
from missionkit.perception.apparent_size import SizeGate, size_gate
from missionkit.perception.ground_plane import ROBOT_DIAMETER, ROBOT_HEIGHT
from missionkit.perception.opencv_helpers import grey
from missionkit.plugin import BoxDetector
from missionkit.plugin_protocols import Prior
from missionkit.units import Degrees, Fraction, Metres, Number, Pixels

SURROUNDINGS: Final = 3.0  # sizes of an object, over which the ground's brightness is averaged
LEAST_FILL: Final = 0.55  # share of its box that a round object fills: π/4, less what is lost


class Blob(BoxDetector):
    """Round objects by their colour; in grey frames by their brightness.

    `hue_deg` names a colour on the circle 0 red, 60 yellow, 120 green, 240 blue. A frame without
    colour, as the simulator draws it, shows no hue: there, and without `hue_deg`, an object is
    what differs by `contrast` from the ground around it. A blob counts if it is as large as an
    object on the ground below appears, give or take `margin`, about round, and not cut by the edge.
    """

    kind: ClassVar[str] = "blob"

    object: str = Field(default="robot", description="what it finds, for trackers")
    diameter: Metres = Field(default=ROBOT_DIAMETER, gt=0, description="of an object")
    height: Metres = Field(default=ROBOT_HEIGHT, ge=0, description="of its top above the ground")
    hue_deg: Annotated[Degrees, Field(ge=0, lt=360)] | None = Field(
        default=None, description="its colour; by brightness alone if absent"
    )
    hue_within_deg: Degrees = Field(default=25.0, gt=0, le=180)
    saturation: Fraction = Field(default=0.35, description="least, of the colour")
    brightness: Literal["bright", "dark"] = Field(
        default="bright", description="how it differs from the ground in a grey frame"
    )
    contrast: Number = Field(default=25.0, gt=0, le=255, description="least, in grey levels")
    margin: Pixels = Field(default=8.0, ge=0, description="of the size it may be off by")

    @override
    def boxes(self, frame: Frame, camera: CameraModel, prior: Prior) -> tuple[BoxDetection, ...]:
        """Return the boxes around the blobs of a frame."""
        gate = size_gate(
            camera, prior.body, prior.ground,
            diameter=self.diameter, top=self.height, margin=self.margin,
        )  # fmt: skip
        spans = None if gate is None else gate.spans(camera)
        if gate is None or spans is None or frame.image is None:
            return ()
        mask = self._mask(frame.image, spans[1])
        _, _, parts, middles = cv2.connectedComponentsWithStats(mask, connectivity=4)
        shapes = (
            _Shape(np.asarray(middle, np.float64), *part)
            for middle, part in zip(middles[1:], parts[1:].tolist(), strict=True)
        )
        return tuple(self._fitting(shapes, gate, mask.shape))

    def _mask(self, image: Image, largest: float) -> Image:
        if image.ndim == 3 and self.hue_deg is not None:
            hue, saturation, value = cv2.split(cv2.cvtColor(image, cv2.COLOR_BGR2HSV))
            off = np.abs((hue * 2.0 - self.hue_deg + 180.0) % 360.0 - 180.0)
            vivid = (saturation >= 255.0 * self.saturation) & (value > self.contrast)
            mask = (off <= self.hue_within_deg) & vivid
        else:
            flat = grey(image).astype(np.float32)
            side = 2 * math.ceil(0.5 * SURROUNDINGS * largest) + 1
            over = flat - cv2.blur(flat, (side, side))
            mask = (over if self.brightness == "bright" else -over) >= self.contrast
        opened = cv2.morphologyEx(mask.astype(np.uint8), cv2.MORPH_OPEN, np.ones((3, 3), np.uint8))
        return np.asarray(opened, np.uint8)

    def _fitting(
        self, shapes: Iterator[_Shape], gate: SizeGate, image: tuple[int, ...]
    ) -> Iterator[BoxDetection]:
        for it in shapes:
            expected = gate.width(*it.middle.tolist())
            off = max(abs(it.width - expected), abs(it.height / gate.aspect - expected))
            fill = it.area / (it.width * it.height)
            inside = it.left > 0 and it.top > 0
            inside = inside and it.left + it.width < image[1] and it.top + it.height < image[0]
            if inside and expected > 0.0 and off <= gate.margin and fill >= LEAST_FILL:
                score = min(fill / (0.25 * math.pi), 1.0) * (1.0 - 0.5 * off / (gate.margin + 1.0))
                size = (float(it.width), float(it.height))
                yield BoxDetection(self.kind, it.middle, size, score, self.object)


class _Shape(NamedTuple):
    """A connected part of the mask: OpenCV's row of it, px."""

    middle: np.ndarray[tuple[int], np.dtype[np.float64]]
    left: int
    top: int
    width: int
    height: int
    area: int
