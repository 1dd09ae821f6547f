"""Objects that look like a template: `perception: [{use: template}]`."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field
from typing_extensions import override

from missionkit.messages import BoxDetection, CameraModel, Image
from missionkit.perception.apparent_size import SizeGate
from missionkit.perception.sized_detector import SizedDetector
from missionkit.perception.template.template_set import TemplateSet, shipped
from missionkit.plugin import InFile
from missionkit.units import Fraction


class Template(SizedDetector):
    """Objects by normalised cross-correlation with templates (P4 section III-A).

    They are matched at the size that an object on the ground below appears in, P4 (7), give or take
    `margin`. `missionkit detector train --kind template` writes `templates`; those that are used
    without are of a ground robot. Colour is not looked at.
    """

    kind: ClassVar[str] = "template"

    templates: Annotated[TemplateSet | None, InFile(TemplateSet)] = Field(
        default=None, description="file of templates, beside the mission"
    )
    least_score: Fraction = Field(default=0.5, description="of what counts")

    @override
    def search(
        self, image: Image, camera: CameraModel, gate: SizeGate, spans: tuple[float, float]
    ) -> tuple[BoxDetection, ...]:
        """Return the boxes around what looks like a template."""
        from missionkit.perception.opencv_helpers import grey  # noqa: PLC0415 heavy
        from missionkit.perception.size_pyramid import boxes_of  # noqa: PLC0415
        from missionkit.perception.template.matching import objects  # noqa: PLC0415

        it = self.templates or shipped()
        found = objects(grey(image), it.arrays, it.width, gate, spans)
        boxes = boxes_of(found, it.score, gate.aspect, camera, self.kind, self.object)
        return tuple(box for box in boxes if box.score >= self.least_score)
