"""Behaviours of a mission as actions of a plan."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from missionkit.behaviors.climb import Climb
from missionkit.behaviors.go_to import HOME, GoTo
from missionkit.behaviors.land import Land as LandBehavior
from missionkit.behaviors.loiter import Loiter
from missionkit.behaviors.orbit import Orbit
from missionkit.behaviors.survey import Corridor as CorridorBehavior
from missionkit.behaviors.survey import Survey as SurveyBehavior
from missionkit.behaviors.take_off import TakeOff as TakeOffBehavior
from missionkit.behaviors.waypoints import Waypoint as WaypointParameters
from missionkit.behaviors.waypoints import Waypoints
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.placed_states import Placed
from missionkit.geodesy import Origin
from missionkit.geometry import vec
from missionkit.interchange.ledger import Ledger
from missionkit.interchange.mission_text import CAMERA
from missionkit.interchange.plan import (
    Action,
    Corridor,
    Land,
    LatLon,
    Place,
    Return,
    Survey,
    TakeOff,
    Turns,
    Waypoint,
    degrees,
    metres,
)
from missionkit.positions import Converted, GeodeticPosition

EVENTS = "its events are left out"
NO_COUNTERPART = "a plan has nothing like the behaviour {!r}"


def spot_of(point: Sequence[float], origin: Origin) -> LatLon:
    """Return where a point of a mission is, as it was written if that was in degrees."""
    if isinstance(point, Converted):
        return LatLon(degrees(point.written.lat), degrees(point.written.lon))
    lat, lon, _ = origin.place(vec(point[0], point[1], 0.0))
    return LatLon(degrees(lat), degrees(lon))


def place_of(point: Sequence[float], origin: Origin) -> Place:
    """Return where a point (north, east, down) of a mission is, with its height."""
    spot = spot_of(point, origin)
    if isinstance(point, Converted) and isinstance(point.written, GeodeticPosition):
        it = point.written
        if it.amsl is not None:
            return Place(*spot, metres(it.amsl), "amsl")
        if it.agl is not None:
            return Place(*spot, metres(it.agl), "agl")
    return Place(*spot, metres(-point[2]), "above_home")


@dataclass
class StateReader:
    """Reads state by state; remembers where the vehicle is by then."""

    mission: Mission
    origin: Origin
    ledger: Ledger
    actions: list[Action] = field(default_factory=list)
    used: set[str] = field(default_factory=set)  # targets that are flown to
    at: Place | None = None  # after the last state

    def take(self, placed: Placed, after: Placed | None, entry: int) -> None:
        """Add what a state does, or refuse it in the ledger.

        Args:
            placed: the state.
            after: the next on the way.
            entry: of the ledger.
        """
        work = placed.state.behavior
        if work is None:
            if not placed.state.final:
                self.ledger.refuse(entry, "its states are active together: a plan has one way")
            return
        next_work = None if after is None else after.state.behavior
        landing = next_work is not None and isinstance(next_work.plugin, LandBehavior)
        plugin = work.plugin
        match plugin:
            case TakeOffBehavior():
                self.actions.append(TakeOff(metres(plugin.height), "above_home", None, entry))
                here = spot_of((0.0, 0.0), self.origin)
                self.at = Place(*here, metres(plugin.height), "above_home")
            case Waypoints():
                self._waypoints(plugin, entry, landing=landing)
            case SurveyBehavior() | CorridorBehavior():
                self._lines(plugin, entry)
            case LandBehavior():
                if not self.actions or not isinstance(self.actions[-1], Return | Land):
                    self.actions.append(Land(None, entry))
            case _:
                self._point(plugin, work.kind, entry, landing=landing)

    def _point(self, plugin: object, kind: str, entry: int, *, landing: bool) -> None:
        """Add what happens at one place."""
        match plugin:
            case GoTo(target="home") if landing:
                self.actions.append(Return(entry))
            case GoTo():
                self._go_to(plugin, entry)
            case Orbit():
                self._orbit(plugin, entry)
            case Loiter() if self.at is not None:
                wait = metres(plugin.seconds)
                heading = plugin.heading_deg
                self._add(Waypoint(self.at, entry, None, wait, heading, stop=wait == 0.0))
            case Climb() if self.at is not None:
                high = self.at._replace(height=metres(plugin.height), reference="above_home")
                self._add(Waypoint(high, entry))
            case _:
                self.ledger.refuse(entry, NO_COUNTERPART.format(kind))

    def _add(self, waypoint: Waypoint) -> None:
        self.actions.append(waypoint)
        self.at = waypoint.place

    def _target(self, name: str) -> Place | None:
        """Return where a target of the mission is, home too."""
        if name == HOME:
            height = 0.0 if self.at is None else self.at.height
            return Place(*spot_of((0.0, 0.0), self.origin), height, "above_home")
        self.used.add(name)
        it = self.mission.targets.get(name)
        return None if it is None else place_of(it.position, self.origin)

    def _go_to(self, plugin: GoTo, entry: int) -> None:
        place = self._target(plugin.target)
        if place is None or any(plugin.standoff):
            self.ledger.refuse(entry, "where it flies is known in flight alone")
            return
        if plugin.height is not None:
            place = place._replace(height=metres(plugin.height), reference="above_home")
        self._add(Waypoint(place, entry, metres(plugin.speed), stop=True))

    def _orbit(self, plugin: Orbit, entry: int) -> None:
        place = self._target(plugin.target)
        if place is None or plugin.turns is None:
            self.ledger.refuse(entry, "a plan circles a known place for a number of turns")
            return
        if plugin.height is not None and (
            place.reference == "amsl" or place.height != plugin.height
        ):
            place = place._replace(height=metres(plugin.height), reference="above_home")
        if plugin.to_height is not None:
            off = abs(plugin.to_height - place.height)
            self.ledger.approximate(entry, "it does not climb on its circles", off)
        speed = metres(plugin.speed)
        radius, turns = metres(plugin.radius), metres(plugin.turns)
        self.actions.append(Turns(place, radius, turns, entry, plugin.clockwise, speed))
        self.at = place

    def _lines(self, plugin: SurveyBehavior | CorridorBehavior, entry: int) -> None:
        ready = plugin.with_camera(self.mission.camera.model())
        if ready.spacing is None:
            self.ledger.refuse(entry, "how far apart its lines are is not known")
            return
        if plugin.from_line > 1:
            left = plugin.from_line - 1
            self.ledger.approximate(entry, "it begins at its first line", left, "lines")
        height, spacing = metres(plugin.height), metres(ready.spacing)
        turn, speed = metres(plugin.turn_around), metres(plugin.speed)
        if isinstance(plugin, SurveyBehavior):
            corners = tuple(spot_of(it, self.origin) for it in plugin.polygon)
            angle = None if plugin.angle_deg is None else metres(plugin.angle_deg)
            self.actions.append(
                Survey(corners, height, "above_home", entry, spacing, angle, turn, speed)
            )
            self.at = Place(*corners[-1], height, "above_home")
        else:
            line = tuple(spot_of(it, self.origin) for it in plugin.line)
            breadth = metres(plugin.breadth)
            self.actions.append(
                Corridor(line, breadth, height, "above_home", entry, spacing, turn, speed)
            )
            self.at = Place(*line[-1], height, "above_home")

    def _waypoints(self, plugin: Waypoints, entry: int, *, landing: bool) -> None:
        first = plugin.places[0]
        bare = len(plugin.places) == 1 and first.height is None and plugin.height is None
        if landing and bare and not isinstance(first.at, str) and len(first.at) == 2:
            self.actions.append(Land(spot_of(first.at, self.origin), entry))
            return
        for it in plugin.places:
            self._waypoint(plugin, it, entry)

    def _waypoint(self, plugin: Waypoints, it: WaypointParameters, entry: int) -> None:
        place = self._where(plugin, it)
        look = None if it.look_at is None else self._target(it.look_at)
        if place is None:
            self.ledger.refuse(entry, f"the position of {it.at!r} is known in flight alone")
            return
        if it.event is not None:
            self.ledger.approximate(entry, EVENTS)
        if it.payload not in {None, CAMERA}:
            self.ledger.approximate(entry, f"payload {it.payload!r} is left out")
        self._add(
            Waypoint(
                place,
                entry,
                metres(it.speed or plugin.speed),
                metres(it.wait),
                None if it.heading_deg is None else metres(it.heading_deg),
                photo=it.payload == CAMERA,
                look_at=look,
                stop=it.stop and it.wait == 0.0,
            )
        )

    def _where(self, plugin: Waypoints, it: WaypointParameters) -> Place | None:
        """Return a place with its height, as `waypoints` finds it."""
        height = it.height
        if isinstance(it.at, str):
            place = self._target(it.at)
            height = plugin.height if height is None else height
        elif len(it.at) == 3:
            place = place_of(it.at, self.origin)
        else:
            height = plugin.height if height is None else height
            spot = spot_of(it.at, self.origin)
            place = self.at._replace(lat=spot.lat, lon=spot.lon) if self.at else Place(*spot)
        if place is None or height is None:
            return place
        return place._replace(height=metres(height), reference="above_home")
