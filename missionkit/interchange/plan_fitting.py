"""A plan as a mission can fly it: heights resolved, take-off and return added, misfits refused."""

from __future__ import annotations

from collections.abc import Iterable
from typing import NamedTuple, TypeVar

from missionkit.behaviors.orbit import MOST_TURNS
from missionkit.geodesy import Origin
from missionkit.interchange.bounded_input import ForeignFileError
from missionkit.interchange.fence_fitting import fitted_fence
from missionkit.interchange.ledger import Ledger, Outcome
from missionkit.interchange.lines import deviation, flown, local
from missionkit.interchange.plan import (
    Action,
    Corridor,
    Home,
    Land,
    LatLon,
    Place,
    Plan,
    Rally,
    Reference,
    Return,
    Survey,
    TakeOff,
    Turns,
    Waypoint,
    metres,
)
from missionkit.polygons import unfit
from missionkit.positions import FARTHEST

SPEED = 5.0  # m/s, where a file has none
LOWEST_TAKE_OFF = 2.0  # m
HIGHEST = 10_000.0  # m above home
NO_HEIGHT = "it has no height: --height 30 says how high to fly, in metres above home"
TERRAIN = (
    "its height is above the terrain, which a mission does not know: --flat-ground takes the "
    "ground as level with home"
)
ELLIPSOID = (
    "its height is above the ellipsoid: --heights amsl, above_home or agl says what is meant"
)
Flown = TypeVar("Flown", Survey, Corridor)


class FitOptions(NamedTuple):
    """What the user adds to a file that does not say it."""

    home: Home | None = None
    height: float | None = None  # m above home, of places without a height
    heights: Reference | None = None  # of heights above the ellipsoid
    flat_ground: bool = False
    spacing: float | None = None  # m, of surveys without one


class _Fit(NamedTuple):
    options: FitOptions
    origin: Origin
    ledger: Ledger

    def height(self, height: float, reference: Reference, item: int) -> tuple[float, Reference]:
        """Return a height with a reference that missions have.

        Raises:
            _MisfitError: it has none.
        """
        if reference == "ellipsoid" and self.options.heights is not None:
            reference = self.options.heights
        if reference == "none":
            if self.options.height is None:
                raise _MisfitError(NO_HEIGHT)
            height, reference = self.options.height, "above_home"
        if reference == "ellipsoid":
            raise _MisfitError(ELLIPSOID)
        if reference == "agl":
            if not self.options.flat_ground:
                raise _MisfitError(TERRAIN)
            self.ledger.approximate(item, "the ground is taken as flat, level with home")
        return height, reference

    def above_home(self, height: float, reference: Reference, item: int) -> float:
        """Return a height above home (m).

        Raises:
            _MisfitError: it is not above it.
        """
        height, reference = self.height(height, reference, item)
        if reference == "amsl":
            height = metres(height - self.origin.altitude)
        if height <= 0.0:
            raise _MisfitError(
                f"it is {height:.1f} m above home: a mission flies above its take-off point"
            )
        if height > HIGHEST:
            raise _MisfitError(f"it is {height:,.0f} m above home: at most {HIGHEST:,.0f} m")
        return height

    def place(self, place: Place, item: int) -> Place:
        """Return a place with a height that missions have.

        Raises:
            _MisfitError: it has none, or lies too far away.
        """
        self.near(place.spot)
        height, reference = self.height(place.height, place.reference, item)
        self.above_home(height, reference, item)
        return Place(*place.spot, height, reference)

    def looked_at(self, place: Place, item: int) -> Place:
        """Return a place to look at, with a height that missions have.

        Raises:
            _MisfitError: it has none, or lies too far away.
        """
        self.near(place.spot)
        height, reference = self.height(place.height, place.reference, item)
        if abs(height) > HIGHEST:
            raise _MisfitError(f"it looks at a height of {height:,.0f} m: at most {HIGHEST:,.0f} m")
        return Place(*place.spot, height, reference)

    def near(self, *spots: LatLon) -> None:
        """Require places to be within reach of home.

        Raises:
            _MisfitError: one is too far away.
        """
        away = max(self.origin.distance(*it) for it in spots)
        if away > FARTHEST:
            raise _MisfitError(f"it lies {away / 1e3:,.0f} km from home")


class _MisfitError(Exception):
    """Why an action is refused."""


def fit(plan: Plan, options: FitOptions, ledger: Ledger) -> Plan:
    """Return a plan that a mission can fly from take-off to landing.

    Args:
        plan: as a file has it.
        options: what the file does not say.
        ledger: what is refused, approximated and added is noted there.

    Raises:
        ForeignFileError: nothing of it can be flown.
    """
    home = _home(plan, options, ledger)
    if home is None:
        raise ForeignFileError("it has no place on the earth that could be flown to")
    fitting = _Fit(options, Origin(*home), ledger)
    actions = list(_fitted(plan.actions, fitting))
    actions = [it for it in actions if _whole_item(it, ledger)]
    if any(map(_goes_somewhere, plan.actions)) and not any(map(_goes_somewhere, actions)):
        raise ForeignFileError("none of its places can be flown to")
    rally = tuple(_rallied(plan.rally, fitting))
    highest = max((_top(it, fitting) for it in actions), default=0.0)
    fence, actions = fitted_fence(plan.fence, actions, fitting.origin, highest, ledger)
    if not actions and fence is None and not rally:
        raise ForeignFileError("nothing in it can be flown")
    return Plan(home, tuple(_whole(actions, fitting)), fence, rally)


def _home(plan: Plan, options: FitOptions, ledger: Ledger) -> Home | None:
    given = options.home or plan.home
    if given is not None:
        return given
    first = next((it for action in plan.actions for it in spots_of(action)), None)
    if first is None and plan.fence is not None:
        first = next(iter(plan.fence.outline), None)
    if first is None:
        return None
    if any(_reference(it) == "amsl" for it in plan.actions):
        raise ForeignFileError(
            "its heights are above sea level and it does not say where home is: "
            "--home LAT,LON,ALT says so"
        )
    ledger.added.append("home, at the first place and 0 m altitude: --home LAT,LON,ALT says where")
    return Home(*first, 0.0)


def _reference(action: Action) -> Reference:
    match action:
        case Waypoint() | Turns():
            return action.place.reference
        case TakeOff() | Survey() | Corridor():
            return action.reference
        case _:
            return "none"


def spots_of(action: Action) -> tuple[LatLon, ...]:
    """Return where an action takes the vehicle, as far as its file says."""
    match action:
        case Waypoint() | Turns():
            return (action.place.spot,)
        case Survey():
            return action.polygon
        case Corridor():
            return action.line
        case TakeOff() | Land():
            return () if action.spot is None else (action.spot,)
        case _:
            return ()


def _fitted(actions: Iterable[Action], fitting: _Fit) -> Iterable[Action]:
    for action in actions:
        try:
            yield _one(action, fitting)
        except (_MisfitError, ValueError) as error:
            fitting.ledger.refuse(action.item, str(error))


def _goes_somewhere(action: Action) -> bool:
    return not isinstance(action, TakeOff | Return | Land)


def _whole_item(action: Action, ledger: Ledger) -> bool:
    """Say whether an action is flown: of an item that is refused in part, nothing is."""
    return action.item < 0 or ledger.entries[action.item].outcome is not Outcome.REFUSED


def _require_positive(action: Action) -> None:
    """Refuse numbers that no behaviour takes, as a file edited by hand may have.

    Raises:
        _MisfitError: one is not more than 0, or too large.
    """
    for name in ("speed", "radius", "turns", "spacing", "breadth"):
        value = getattr(action, name, None)
        if value is not None and value <= 0.0:
            raise _MisfitError(f"its {name} is {value:g}: expected more than 0")
    for name in ("wait", "turn_around"):
        if getattr(action, name, 0.0) < 0.0:
            raise _MisfitError(f"its {name.replace('_', '-')} is below 0")
    if isinstance(action, Turns) and action.turns > MOST_TURNS:
        raise _MisfitError(f"{action.turns:g} turns: at most {MOST_TURNS}")


def _one(action: Action, fitting: _Fit) -> Action:
    _require_positive(action)
    match action:
        case TakeOff():
            return _take_off(action, fitting)
        case Waypoint():
            at = action.look_at
            look = None if at is None else fitting.looked_at(at, action.item)
            place = fitting.place(action.place, action.item)
            return action._replace(place=place, look_at=look, speed=action.speed or SPEED)
        case Turns(place=place):
            fitting.near(place.spot)
            height = fitting.above_home(place.height, place.reference, action.item)
            place = Place(*place.spot, height, "above_home")
            return action._replace(place=place, speed=action.speed or SPEED)
        case Survey():
            _require_area(action, fitting)
            return _lines(action, fitting)
        case Corridor():
            return _lines(action, fitting)
        case Land(spot=spot) if spot is not None:
            fitting.near(spot)
    return action


def _take_off(action: TakeOff, fitting: _Fit) -> TakeOff:
    height = fitting.above_home(action.height, action.reference, action.item)
    if action.spot is not None:
        away = fitting.origin.distance(*action.spot)
        if away > 1.0:
            fitting.ledger.approximate(action.item, "it climbs where it stands", metres(away))
    return TakeOff(height, "above_home", None, action.item)


def _require_area(action: Survey, fitting: _Fit) -> None:
    fitting.near(*action.polygon)
    if wrong := unfit(local(action.polygon, fitting.origin)):
        raise _MisfitError(wrong)


def _lines(action: Flown, fitting: _Fit) -> Flown:
    """Resolve the height of a survey or corridor, and compare its lines with those of the file."""
    fitting.near(*spots_of(action))
    height = fitting.above_home(action.height, action.reference, action.item)
    spacing = action.spacing or fitting.options.spacing
    if spacing is None:
        spacing = metres(0.5 * height)
        fitting.ledger.added.append(f"lines {spacing:g} m apart, half the height: --spacing")
    fitted = action._replace(
        height=height, reference="above_home", spacing=spacing, speed=action.speed or SPEED
    )
    path = flown(fitted, fitting.origin)
    if action.expanded:
        off = deviation(action.expanded, path, fitting.origin)
        note = "the lines of a mission, by the same area and spacing"
    else:
        off, note = 0.5 * spacing, "its lines are not in the file: those of a mission"
    if not action.exact:
        fitting.ledger.approximate(action.item, note, metres(off))
    return fitted._replace(expanded=(), exact=True)


def _top(action: Action, fitting: _Fit) -> float:
    """Return how high an action goes above home (m)."""
    match action:
        case Waypoint() | Turns():
            place = action.place
            return fitting.above_home(place.height, place.reference, action.item)
        case TakeOff() | Survey() | Corridor():
            return action.height
        case _:
            return 0.0


def _rallied(rally: Iterable[Rally], fitting: _Fit) -> Iterable[Rally]:
    for each in rally:
        try:
            yield each._replace(place=fitting.place(each.place, each.item))
        except _MisfitError as error:
            fitting.ledger.refuse(each.item, str(error))


def _whole(actions: list[Action], fitting: _Fit) -> Iterable[Action]:
    """Yield the actions between a take-off and a return."""
    if not actions or not isinstance(actions[0], TakeOff):
        first = next((top for it in actions if (top := _top(it, fitting)) > 0.0), 10.0)
        height = max(LOWEST_TAKE_OFF, first)
        fitting.ledger.added.append(f"a take-off to {height:g} m: the file has none")
        yield TakeOff(height, "above_home", None, -1)
    yield from actions
    if not actions or not isinstance(actions[-1], Return | Land):
        fitting.ledger.added.append("the flight home and the landing: the file has none")
        yield Return(-1)
