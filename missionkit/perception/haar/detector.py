"""Objects that a trained cascade finds: `perception: [{use: haar}]`."""

from __future__ import annotations

import math
from typing import Annotated, ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.messages import BoxDetection, CameraModel, Image
from missionkit.perception.apparent_size import LEAST_SIDE, SizeGate
from missionkit.perception.haar.cascade import HaarCascade, shipped
from missionkit.perception.sized_detector import SizedDetector
from missionkit.plugin import InFile
from missionkit.units import Fraction


class Haar(SizedDetector):
    """Objects by a cascade of boosted Haar-like features (P4 section III-A).

    It searches at the size that an object on the ground below appears in, give or take `margin`
    (P4's k); without the `gate` at every size. `missionkit detector train` writes a `cascade`; the
    one that is used without is of a ground robot. Colour is not looked at.
    """

    kind: ClassVar[str] = "haar"

    cascade: Annotated[HaarCascade | None, InFile(HaarCascade)] = Field(
        default=None, description="file of a trained cascade, beside the mission"
    )
    gate: bool = Field(default=True, description="search only at the size that height predicts")
    least_score: Fraction = Field(default=0.2, description="of what counts")

    @override
    def search(
        self, image: Image, camera: CameraModel, gate: SizeGate, spans: tuple[float, float]
    ) -> tuple[BoxDetection, ...]:
        """Return the boxes around what the cascade passes."""
        from missionkit.perception.haar.window_search import objects  # noqa: PLC0415 heavy
        from missionkit.perception.opencv_helpers import grey  # noqa: PLC0415
        from missionkit.perception.size_pyramid import boxes_of  # noqa: PLC0415

        if not self.gate:
            gate = gate._replace(margin=math.inf)
            spans = (2.0 * LEAST_SIDE, 0.5 * min(camera.width, camera.height))
        it = self.cascade or shipped()
        found = objects(grey(image), it.arrays, it.side, it.width, gate, spans)
        boxes = boxes_of(found, it.score, gate.aspect, camera, self.kind, self.object)
        return tuple(box for box in boxes if box.score >= self.least_score)

    @override
    def warm_up(self) -> None:
        """Compile the search."""
        from missionkit.perception.haar.warm_up import warm_up  # noqa: PLC0415 compiles

        warm_up()
