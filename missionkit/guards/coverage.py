"""How much of an area has been photographed."""

from __future__ import annotations

import math
from functools import cached_property
from typing import Annotated, Any, ClassVar, Self

import numpy as np
import numpy.typing as npt
from pydantic import Field, PrivateAttr, model_validator
from typing_extensions import override

from missionkit.camera_pointing import seen_mount
from missionkit.geometry import norm, to_matrix
from missionkit.messages import CameraModel, Estimate, Verdict
from missionkit.messages.region import Interval, Quantity, Region
from missionkit.plugin import WindowGuard
from missionkit.polygons import area, contains, unfit
from missionkit.positions import GroundPosition
from missionkit.units import Fraction, Metres, Pixels, Seconds

CELLS = 2_000  # into which an area is divided, about
LEAST_DEPTH = 0.17  # sine of 10 deg below the horizon, for a ray that counts
Cells = npt.NDArray[np.float64]  # (N, 2), m, north and east


class Covered(WindowGuard):
    """Holds once a share `at_least` of the area inside `polygon` has been photographed sharply.

    Every frame of the mission's camera counts that comes while motion blurs it by at most `blur`:

        (v / h + |ω|) f t_exposure

    with v the speed, h the height above `ground` and ω the turn rate. What it shows is where the
    rays of its corners meet the ground, by the estimated pose. The area is divided into about 2000
    cells, of which the middle counts. Unknown while the camera's place is not known.
    """

    kind: ClassVar[str] = "covered"
    polygon: Annotated[
        tuple[GroundPosition, ...], Field(min_length=3, description="corners of the area")
    ]
    at_least: Fraction = Field(default=0.98, gt=0, description="share of the area")
    ground: Metres = Field(default=0.0, description="height of the ground above the take-off point")
    blur: Pixels = Field(default=1.5, gt=0, description="most by which motion blurs a frame")
    exposure: Seconds = Field(default=0.004, gt=0, description="exposure time")

    _camera: CameraModel | None = PrivateAttr(default=None)

    @model_validator(mode="after")
    def _an_area(self) -> Self:
        if wrong := unfit(self.polygon):
            raise ValueError(f"polygon: {wrong}")
        return self

    @override
    def with_camera(self, camera: CameraModel) -> Self:
        copied = self.model_copy()
        copied._camera = camera  # noqa: SLF001 - the copy is of this class
        return copied

    @override
    def begin(self) -> int:
        return 0

    @override
    def advance(self, memory: Any, seen: Estimate) -> int:
        done = int(memory)
        taken = any(not look.silent for look in seen.looks)
        if self._camera is None or not taken or seen.health.diverged or not seen.health.aligned:
            return done
        return done | self._shown(self._camera, seen)

    @override
    def check(self, memory: Any, seen: Estimate) -> Verdict:
        if self._camera is None:
            return Verdict.unknown("there is no camera")
        share = int(memory).bit_count() / len(self._cells)
        return Verdict.at_least(share, self.at_least, "share photographed")

    @override
    def region(self) -> Region:
        name = f"share of {abs(area(self.polygon)):.0f} m² photographed"
        return Region.of(Quantity(name, most=1.0), Interval.at_least(self.at_least))

    @cached_property
    def _cells(self) -> Cells:
        """The middle of each cell of the area."""
        edge = math.sqrt(abs(area(self.polygon)) / CELLS)
        low, high = np.min(self.polygon, axis=0), np.max(self.polygon, axis=0)
        north = np.arange(low[0] + 0.5 * edge, high[0], edge).tolist()
        east = np.arange(low[1] + 0.5 * edge, high[1], edge).tolist()
        inside = [(n, e) for n in north for e in east if contains(self.polygon, (n, e))]
        return np.array(inside or [np.mean(self.polygon, axis=0)])

    def _shown(self, camera: CameraModel, seen: Estimate) -> int:
        """Return the cells that a frame shows, one bit each; 0 if it is blurred."""
        height = -float(seen.position[2]) - self.ground
        focal = math.sqrt(camera.matrix[0, 0] * camera.matrix[1, 1])
        if height <= 0.0 or (
            (norm(seen.velocity) / height + norm(seen.rates)) * focal * self.exposure > self.blur
        ):
            return 0
        right, low = camera.width - 0.5, camera.height - 0.5
        corners = np.array(
            ((-0.5, right, right, -0.5), (-0.5, -0.5, low, low), (1.0, 1.0, 1.0, 1.0))
        )
        mount = seen_mount(camera, seen)
        if mount is None:
            return 0
        body = to_matrix(seen.attitude)
        turned = body @ to_matrix(mount.rotation)
        rays = turned @ np.linalg.solve(camera.matrix, corners)
        rays /= np.linalg.norm(rays, axis=0)
        if rays[2].min() < LEAST_DEPTH:
            return 0
        place = seen.position + body @ mount.translation
        spots = (place[:2, None] + (-place[2] - self.ground) * rays[:2] / rays[2]).T
        sides = np.roll(spots, -1, axis=0) - spots
        off = self._cells[:, None, :] - spots[None, :, :]
        turns = sides[:, 0] * off[:, :, 1] - sides[:, 1] * off[:, :, 0]
        inside = (turns >= 0.0).all(axis=1) | (turns <= 0.0).all(axis=1)
        return int.from_bytes(np.packbits(inside, bitorder="little").tobytes(), "little")
