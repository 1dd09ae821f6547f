"""Where a mission is on the earth, and its named places, in words."""

from __future__ import annotations

from collections.abc import Iterator

from missionkit.chart.model.mission import Mission
from missionkit.chart.prose.phrases import counted
from missionkit.geodesy import Origin
from missionkit.geometry import vec
from missionkit.guards.geofence import InsideFence
from missionkit.units import Point


def place_texts(mission: Mission) -> Iterator[str]:
    """Yield the origin, each target and the fence, a sentence each."""
    origin = mission.geodetic_origin
    if origin is not None:
        yield (
            f"[0, 0, 0] is the take-off point, {_degrees(origin.latitude, origin.longitude)}, "
            f"{origin.altitude:g} m above mean sea level."
        )
    for name, target in mission.targets.items():
        yield f"{name}: {_place(target.position, origin)}."
    if mission.fence is not None:
        yield f"The fence: {_fence(mission.fence)}."


def _place(point: Point, origin: Origin | None) -> str:
    north, east, down = (round(part, 2) + 0.0 for part in point)
    level = f"{abs(north):g} m {'north' if north >= 0 else 'south'} and "
    level += f"{abs(east):g} m {'east' if east >= 0 else 'west'} of the take-off point, "
    high = f"{abs(down):g} m {'above' if down <= 0 else 'below'} it"
    if origin is None:
        return level + high
    latitude, longitude, altitude = origin.place(vec(*point))
    return f"{level}{high} ({_degrees(latitude, longitude)}, {altitude:.1f} m above sea level)"


def _degrees(latitude: float, longitude: float) -> str:
    return f"{latitude:.7f}, {longitude:.7f}"


def _fence(fence: InsideFence) -> str:
    norths, easts = ([round(it, 1) for it in row] for row in zip(*fence.outline(), strict=True))
    corners = counted(len(fence.outline()), "corner")
    limits = (
        f"{corners} from {min(norths):g} to {max(norths):g} m north and {min(easts):g} to "
        f"{max(easts):g} m east, up to {fence.ceiling:g} m"
    )
    holes = counted(len(fence.holes), "hole")
    return f"{limits}, with {holes}" if fence.holes else limits
