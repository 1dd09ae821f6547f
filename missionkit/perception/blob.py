"""Objects that differ from the ground in colour, or in brightness: `perception: [{use: blob}]`."""

from __future__ import annotations

from typing import Annotated, ClassVar, Literal

from pydantic import Field
from typing_extensions import override

from missionkit.messages import BoxDetection, CameraModel, Image
from missionkit.perception.apparent_size import SizeGate
from missionkit.perception.sized_detector import SizedDetector
from missionkit.units import Degrees, Fraction, Number, Pixels


class Blob(SizedDetector):
    """Round objects by their colour; in grey frames by their brightness.

    `hue_deg` names a colour on the circle 0 red, 60 yellow, 120 green, 240 blue. A frame without
    colour, as the simulator draws it, shows no hue: there, and without `hue_deg`, an object is
    what differs by `contrast` from the ground around it. A blob counts if it is as large as an
    object on the ground below appears, give or take `margin`, about round, and not cut by the edge.
    """

    kind: ClassVar[str] = "blob"

    hue_deg: Annotated[Degrees, Field(ge=0, lt=360)] | None = Field(
        default=None, description="its colour; by brightness alone if absent"
    )
    hue_within_deg: Degrees = Field(default=25.0, gt=0, le=180)
    saturation: Fraction = Field(default=0.35, description="least, of the colour")
    brightness: Literal["bright", "dark"] = Field(
        default="bright", description="how it differs from the ground in a grey frame"
    )
    contrast: Number = Field(default=25.0, gt=0, le=255, description="least, in grey levels")
    margin: Pixels = Field(default=8.0, gt=0, description="of the size it may be off by")

    @override
    def search(
        self, image: Image, camera: CameraModel, gate: SizeGate, spans: tuple[float, float]
    ) -> tuple[BoxDetection, ...]:
        """Return the boxes around the blobs of an image."""
        from missionkit.perception import blob_search  # noqa: PLC0415 heavy

        if image.ndim == 3 and self.hue_deg is not None:
            colour = blob_search.Colour(self.hue_deg, self.hue_within_deg, self.saturation)
            mask = blob_search.of_colour(image, colour, self.contrast)
        else:
            sign = 1.0 if self.brightness == "bright" else -1.0
            mask = blob_search.of_contrast(image, sign, self.contrast, spans[1])
        found = blob_search.round_parts(mask, gate)
        return tuple(BoxDetection(self.kind, *it, self.object, sized=False) for it in found)
