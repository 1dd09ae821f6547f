"""A mission as a plan: the way that it takes when each state is done, one after the other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from missionkit.chart.checks.geofence_violations import walls
from missionkit.chart.model.guard_expressions import Use
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.placed_states import Placed
from missionkit.errors import UsageError
from missionkit.geodesy import Origin
from missionkit.interchange.behavior_actions import StateReader, place_of, spot_of
from missionkit.interchange.ledger import Ledger, Outcome
from missionkit.interchange.mission_text import LOOK, RALLY, TURNS
from missionkit.interchange.plan import Fence, Home, Plan, Rally, metres

OFF_THE_WAY = "it is not on the way from the start that 'done' leads along: a plan has one way"
WHOLE = (Outcome.KEPT, Outcome.APPROXIMATED)
FAILSAFE = "failsafes stay with missionkit: set those of the autopilot"


def mission_plan(mission: Mission, home: Home | None, ledger: Ledger) -> Plan:
    """Return the plan of a mission.

    Args:
        mission: as loaded.
        home: where [0, 0, 0] is, for a mission without an origin.
        ledger: gets an entry for each state, target, failsafe and the fence.
    """
    origin = _origin(mission, home)
    entries = {it.name: ledger.open("state", it.name) for it in mission.walk()}
    reader = StateReader(mission, origin, ledger)
    way = list(main_line(mission))
    for count, placed in enumerate(way):
        after = way[count + 1] if count + 1 < len(way) else None
        reader.take(placed, after, entries[placed.name])
    passed = {it.name for it in way} | {it.parent for it in way}
    for name, entry in entries.items():
        if name not in passed:
            ledger.refuse(entry, OFF_THE_WAY)
    rally = tuple(_targets(mission, origin, ledger, reader))
    for it in mission.failsafes:
        ledger.refuse(ledger.open("failsafe", it.name), FAILSAFE)
    fence = _fence(mission, origin, ledger)
    actions = (it for it in reader.actions if ledger.entries[it.item].outcome in WHOLE)
    start = Home(origin.latitude, origin.longitude, origin.altitude)
    return Plan(start, tuple(actions), fence, rally)


def _origin(mission: Mission, home: Home | None) -> Origin:
    if home is not None:
        return Origin(*home)
    if mission.geodetic_origin is None:
        raise UsageError(
            f"mission {mission.name!r} has no 'origin': --home LAT,LON,ALT says where its "
            "[0, 0, 0] is"
        )
    return mission.geodetic_origin


def main_line(mission: Mission) -> Iterator[Placed]:
    """Yield the states that are active one after the other when each is done."""
    states = mission.by_name()
    name: str | None = mission.initial.to[0]
    seen: set[str] = set()
    while name is not None and name not in seen:
        seen.add(name)
        placed = states[name]
        state = placed.state
        if state.history is not None:
            name = None if state.default is None else state.default.to[0]
        elif state.states and not state.parallel:
            name = next(iter(state.states)) if state.initial is None else state.initial.to[0]
        else:
            yield placed
            name = _after(placed, states)


def _after(placed: Placed, states: Mapping[str, Placed]) -> str | None:
    """Return where `done` leads, from the state or from those around it."""
    here: Placed | None = placed
    while here is not None:
        for out in here.state.transitions:
            if out.to and isinstance(out.when, Use) and out.when.kind == "done":
                return out.to[0]
        here = None if here.parent is None else states[here.parent]
    return None


def _targets(
    mission: Mission, origin: Origin, ledger: Ledger, reader: StateReader
) -> Iterator[Rally]:
    for name, it in mission.targets.items():
        entry = ledger.open("target", name)
        if name.startswith(f"{RALLY}-"):
            yield Rally(place_of(it.position, origin), entry)
        elif name not in reader.used and not name.startswith((f"{LOOK}-", f"{TURNS}-")):
            ledger.refuse(entry, "nothing on the way flies to it")


def _fence(mission: Mission, origin: Origin, ledger: Ledger) -> Fence | None:
    found = walls(mission)
    if mission.fence is not None and mission.fence not in found:
        found = (mission.fence, *found)
    fence: Fence | None = None
    for count, it in enumerate(found):
        entry = ledger.open("fence", f"fence {count + 1}")
        if count:
            ledger.refuse(entry, "a plan has one fence")
            continue
        holes = tuple(
            (tuple(spot_of(corner, origin) for corner in hole.polygon), entry) for hole in it.holes
        )
        if high := [hole.height for hole in it.holes if hole.height is not None]:
            note = "its holes reach to the sky, though they may be flown over"
            ledger.approximate(entry, note, min(high))
        corners = tuple(spot_of(corner, origin) for corner in it.outline())
        fence = Fence(corners, holes, metres(it.ceiling), entry)
    return fence
