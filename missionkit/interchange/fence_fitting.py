"""The fence of a plan as a mission keeps it, and the actions that stay inside it."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from missionkit.geodesy import Origin
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.lines import earth, local
from missionkit.interchange.plan import Action, Fence, Land, LatLon, Turns, Waypoint, metres
from missionkit.polygons import Corner, inside_of, margin, unfit
from missionkit.positions import FARTHEST

HEADROOM = 20.0  # m, from the highest place to the ceiling
LOWEST_CEILING = 30.0  # m
AROUND = 1_000.0  # m, from the holes and the places to an outline that the file does not have


def fitted_fence(
    fence: Fence | None, actions: list[Action], origin: Origin, highest: float, ledger: Ledger
) -> tuple[Fence | None, list[Action]]:
    """Return the fence, and the actions within it; what does not fit is refused in the ledger.

    Args:
        fence: as the file has it.
        actions: fitted.
        origin: of the mission.
        highest: m above home, of the actions.
        ledger: of the file.
    """
    if fence is None:
        return None, actions
    outline = local(fence.outline, origin)
    if outline and (wrong := _misplaced(fence.outline, outline, origin)):
        ledger.refuse(fence.item, wrong)
        fence, outline = fence._replace(outline=(), item=-1), ()
    holes = list(_fitting_holes(fence, outline, origin, ledger))
    if not outline and not holes:
        return None, actions
    if not outline:
        corners = [it for hole, _ in holes for it in hole] + _places(actions, origin) + [(0.0, 0.0)]
        outline = local(earth(_box(corners), origin), origin)
        ledger.added.append(f"an outline of the fence, {AROUND:g} m round everything")
    height = fence.height
    if height is None:
        height = metres(max(LOWEST_CEILING, highest + HEADROOM))
        ledger.added.append(f"a ceiling of the fence, {height:g} m: the file has none")
    rings = [hole for hole, _ in holes]
    kept = [it for it in actions if _stays(it, outline, rings, origin, ledger)]
    corners_of = fence.outline or earth(outline, origin)
    spots = tuple((fence.holes[at][0], fence.holes[at][1]) for _, at in holes)
    return Fence(corners_of, spots, height, fence.item), kept


def _misplaced(spots: Sequence[LatLon], outline: Sequence[Corner], origin: Origin) -> str:
    if wrong := _too_far(spots, origin) or unfit(outline):
        return wrong
    return "" if margin(outline, (0.0, 0.0)) >= 0.0 else "home lies outside of it"


def _too_far(spots: Sequence[LatLon], origin: Origin) -> str:
    far = max(origin.distance(*it) for it in spots) > FARTHEST
    return "it reaches farther than 100 km from home" if far else ""


def _fitting_holes(
    fence: Fence, outline: Sequence[Corner], origin: Origin, ledger: Ledger
) -> Iterable[tuple[tuple[Corner, ...], int]]:
    for at, (spots, item) in enumerate(fence.holes):
        corners = local(spots, origin)
        wrong = _too_far(spots, origin) or unfit(corners)
        if not wrong and margin(corners, (0.0, 0.0)) > 0.0:
            wrong = "home lies inside of it"
        if not wrong and outline and not inside_of(corners, outline):
            wrong = "it does not lie inside the inclusion: a mission's fence has holes only"
        if wrong:
            ledger.refuse(item, wrong)
        else:
            yield corners, at


def _places(actions: Iterable[Action], origin: Origin) -> list[Corner]:
    return [it for action in actions for it in local(_spots(action), origin)]


def _spots(action: Action) -> tuple[LatLon, ...]:
    match action:
        case Waypoint() | Turns():
            return (action.place.spot,)
        case Land(spot=spot) if spot is not None:
            return (spot,)
        case _:
            return getattr(action, "polygon", getattr(action, "line", ()))


def _box(corners: Sequence[Corner]) -> tuple[Corner, ...]:
    norths, easts = zip(*corners, strict=True)
    south, north = min(norths) - AROUND, max(norths) + AROUND
    west, east = min(easts) - AROUND, max(easts) + AROUND
    return (south, west), (north, west), (north, east), (south, east)


def _stays(
    action: Action,
    outline: Sequence[Corner],
    holes: Sequence[Sequence[Corner]],
    origin: Origin,
    ledger: Ledger,
) -> bool:
    """Refuse an action with a place outside the fence."""
    for spot in _spots(action) if isinstance(action, Waypoint | Turns | Land) else ():
        (at,) = local([spot], origin)
        if margin(outline, at) < 0.0 or any(margin(hole, at) > 0.0 for hole in holes):
            ledger.refuse(action.item, "it lies outside the fence of the same file")
            return False
    return True
