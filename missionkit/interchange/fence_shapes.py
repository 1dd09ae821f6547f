"""Polygons and circles of ground stations as the one fence of a mission."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from missionkit.geodesy import Origin
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.lines import earth
from missionkit.interchange.plan import Fence, LatLon

CORNERS = 48  # of the polygon that stands for a circle
MOST_RADIUS = 100_000.0  # m
SEVERAL = (
    "several inclusions: autopilots differ in whether the vehicle must stay inside one or inside "
    "all of them, and a mission has one"
)
Shape = tuple[tuple[LatLon, ...], int]  # corners, entry of the ledger


@dataclass
class FenceShapes:
    """What was read so far."""

    inside: list[Shape] = field(default_factory=list)
    outside: list[Shape] = field(default_factory=list)

    def polygon(
        self, corners: tuple[LatLon, ...] | None, entry: int, ledger: Ledger, *, inward: bool
    ) -> None:
        """Add a polygon.

        Args:
            corners: in order; the last may repeat the first; None: they cannot be read.
            entry: of the ledger.
            ledger: in which a wrong one is refused.
            inward: whether to stay inside of it.
        """
        ring = open_ring(corners or ())
        if len(ring) < 3:
            ledger.refuse(entry, "it does not have three corners in latitude and longitude")
            return
        (self.inside if inward else self.outside).append((ring, entry))

    def circle(
        self,
        centre: LatLon | None,
        radius: float | None,
        entry: int,
        ledger: Ledger,
        *,
        inward: bool,
    ) -> None:
        """Add a circle, as a polygon on the safe side of it.

        Args:
            centre: of the circle.
            radius: m.
            entry: of the ledger.
            ledger: where the difference is noted.
            inward: whether to stay inside of it.
        """
        if centre is None or radius is None or not 0.1 <= radius <= MOST_RADIUS:
            ledger.refuse(entry, "expected a centre and a radius of 0.1 m to 100 km")
            return
        shrink = math.cos(math.pi / CORNERS)
        reach = radius if inward else radius / shrink
        off = radius * (1.0 - shrink) if inward else reach - radius
        ledger.approximate(entry, f"a polygon of {CORNERS} corners on the safe side", off)
        self.polygon(_round(centre, reach), entry, ledger, inward=inward)

    def fence(self, ledger: Ledger) -> Fence | None:
        """Return one fence with holes; without an inclusion its outline is empty."""
        inside = self.inside
        if len(inside) > 1:
            for _, entry in inside:
                ledger.refuse(entry, SEVERAL)
            inside = []
        if not inside and not self.outside:
            return None
        outline = inside[0][0] if inside else ()
        return Fence(outline, tuple(self.outside), None, inside[0][1] if inside else -1)


def open_ring(corners: tuple[LatLon, ...]) -> tuple[LatLon, ...]:
    """Return corners without a last one that repeats the first."""
    return corners[:-1] if len(corners) > 1 and corners[0] == corners[-1] else corners


def _round(centre: LatLon, reach: float) -> tuple[LatLon, ...]:
    origin = Origin(centre.lat, centre.lon, 0.0)
    angles = (math.tau * n / CORNERS for n in range(CORNERS))
    return earth(((reach * math.cos(a), reach * math.sin(a)) for a in angles), origin)
