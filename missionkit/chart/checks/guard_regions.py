"""When a guard holds and when it does not, as boxes, in Kleene's three-valued logic.

What is unknown is neither. Each side comes twice: where it may be so, never too small, and where
it surely is so, never too large. For guards that declare their region exactly the two are equal.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from typing import NamedTuple, cast

from missionkit.chart.checks.interval_boxes import (
    EVERYWHERE,
    NO_BOXES,
    clipped,
    intersection,
    outside,
    union,
)
from missionkit.chart.checks.possible_places import Places
from missionkit.chart.checks.state_tree import StateTree
from missionkit.chart.model import guard_expressions as ex
from missionkit.chart.model.actions import Assign
from missionkit.chart.model.traversal import actions_of
from missionkit.chart.model.variables import Variable, is_number
from missionkit.errors import Place
from missionkit.guards.mdp_policy import MdpPolicy
from missionkit.guards.state_progress import DONE_QUANTITY
from missionkit.messages.region import ONLY_FALSE, ONLY_TRUE, Box, Boxes, Interval, Quantity, Region
from missionkit.plugin import Behavior, Plugin
from missionkit.plugin_containment import PluginError, reporting_faults
from missionkit.plugin_protocols import GuardProtocol


def is_endless(behavior: object) -> bool:
    """Say whether a behaviour goes on until something else ends it."""
    return isinstance(behavior, Behavior) and behavior.endless


class GuardRegion(NamedTuple):
    """Where a guard holds and where it does not: at most, and at least."""

    may: Boxes
    surely: Boxes
    may_not: Boxes
    surely_not: Boxes


ALWAYS_HOLDS = GuardRegion(EVERYWHERE, EVERYWHERE, NO_BOXES, NO_BOXES)
NEVER_HOLDS = GuardRegion(NO_BOXES, NO_BOXES, EVERYWHERE, EVERYWHERE)


class RegionReader:
    """Reads guards as regions; named guards once."""

    def __init__(self, tree: StateTree) -> None:
        self.tree = tree
        self.guards = tree.mission.guards
        self.named: dict[str, GuardRegion] = {}
        self.quantities = dict(_variables(tree))
        self.places = Places(tree.mission)
        self.anywhere = False  # read guards as if a place had any distances

    def truth(self, guard: ex.Expression | None, source: str = "") -> GuardRegion:
        """Return where a guard holds in a transition of the state `source`."""
        match guard:
            case None:
                return ALWAYS_HOLDS
            case ex.Named(name=name):
                if name not in self.named:
                    self.named[name] = self.truth(self.guards[name])
                return self.named[name]
            case ex.All(parts=parts):
                return self._somewhere(_all([self.truth(part, source) for part in parts]))
            case ex.Any(parts=parts):
                fails = [_negated(self.truth(part, source)) for part in parts]
                return _negated(self._somewhere(_all(fails)))
            case ex.Not(part=part):
                return _negated(self.truth(part, source))
            case _:
                return self._leaf(guard, source)

    def _somewhere(self, truth: GuardRegion) -> GuardRegion:
        """Return a region without the boxes whose distances no place has."""
        return truth if self.anywhere else truth._replace(may=self.places.possible(truth.may))

    def apart(self, guard: ex.Expression | None, source: str = "") -> str:
        """Return which places are too far apart for a guard ever to hold, "" if none are."""
        reader = RegionReader(self.tree)
        reader.anywhere = True
        boxes = reader.truth(guard, source).may
        return next(filter(None, map(self.places.conflict, boxes)), "")

    def _leaf(self, guard: ex.Expression, source: str) -> GuardRegion:
        match guard:
            case ex.Use():
                return self._plugin(guard, source)
            case ex.Hysteresis():
                return self._latch(guard)
            case ex.VariableGuard(name=name, op=op, value=value):
                interval = self._interval(name, op, value)
                return _exact(({self.quantities[name]: interval},))
            case ex.In(state=state):
                return self._active(state, source)
            case _:
                return _declared(guard, None)

    def _plugin(self, guard: ex.Use[Plugin], source: str) -> GuardRegion:
        if guard.kind == "done" and source:
            return self.done(source)
        if isinstance(guard.plugin, MdpPolicy):
            return self.truth(self._policy(guard.plugin, guard.place), source)
        return _declared(guard, region_of(guard.plugin))

    def _policy(self, policy: MdpPolicy, place: Place) -> ex.Expression:
        """Return a policy as guards: it is in a chosen state, and in none that comes before."""
        if policy.where:
            states: list[tuple[str, ex.Expression]] = [
                (it, ex.Named(guard, place)) for it, guard in policy.where.items()
            ]
        else:
            states = [(it, ex.In(it, place)) for it in policy.names if it in self.tree.states]
        terms = [
            ex.All((*(ex.Not(before, place) for _, before in states[:n]), guard), place)
            for n, (state, guard) in enumerate(states)
            if state in policy.chosen
        ]
        return ex.Any(tuple(terms), place)

    def done(self, source: str) -> GuardRegion:
        """Return where a state's behaviour, or the states inside it, have finished."""
        state = self.tree.states[source].state
        if state.states:
            finals = self.tree.finals(source)
            done = Quantity(f"{source} done", most=1.0, whole=True, at_entry="zero")
            return _exact(({done: ONLY_TRUE},)) if finals else NEVER_HOLDS
        if state.behavior is not None and is_endless(state.behavior.plugin):
            return NEVER_HOLDS
        return _exact(({DONE_QUANTITY: ONLY_TRUE},))

    def _active(self, state: str, source: str) -> GuardRegion:
        if source and (state == source or state in self.tree.around(source)):
            return ALWAYS_HOLDS
        if source and not self.tree.together(state, source):
            return NEVER_HOLDS
        return _exact(({Quantity(f"in {state}", most=1.0, whole=True): ONLY_TRUE},))

    def _latch(self, guard: ex.Hysteresis) -> GuardRegion:
        quantity = self.measured(guard.part)
        if quantity is None:
            return _declared(guard, None)
        grows = guard.enter > guard.exit
        side = Interval.at_least if grows else Interval.at_most
        begins = clipped(({quantity: side(guard.enter)},))
        if not begins:
            return NEVER_HOLDS
        return _declared(guard, Region(({quantity: side(guard.exit)},), begins))

    def measured(self, part: ex.Expression) -> Quantity | None:
        """Return the quantity that is the value of a guard, if that is known."""
        while isinstance(part, ex.Named):
            part = self.guards[part.name]
        if not isinstance(part, ex.Use):
            return None
        region = region_of(part.plugin)
        boxes = () if region is None else (*region.may, *(region.surely or ()))
        named = {quantity for box in boxes for quantity in box}
        return named.pop() if len(named) == 1 else None

    def _interval(self, name: str, op: str, value: float | str) -> Interval:
        words = self.quantities[name].words
        if words:
            at = float(words.index(str(value)))
            return Interval(at, at)
        number = float(value)
        if op == "equals":
            return Interval(number, number)
        return _SIDES[op](number)


_SIDES = {
    "below": Interval.below,
    "above": Interval.above,
    "at_least": Interval.at_least,
    "at_most": Interval.at_most,
}


def region_of(plugin: Plugin) -> Region | None:
    """Return what a guard declares, None if it declares nothing or cannot."""
    try:
        with reporting_faults():
            return cast(GuardProtocol, plugin).region()
    except PluginError:
        return None


def atom(guard: ex.Expression) -> Quantity:
    """Return an opaque guard, as a quantity that is 0 or 1."""
    return Quantity(ex.text(guard), most=1.0, whole=True)


def _declared(guard: ex.Expression, region: Region | None) -> GuardRegion:
    """Return the truth of one guard; one that is not exact is itself a quantity too.

    So `a` and `not a` exclude each other however little is known of `a`.
    """
    if region is not None and region.surely is None:
        return _exact(region.may)
    known = atom(guard)
    holds: Box = {known: ONLY_TRUE}
    fails: Box = {known: ONLY_FALSE}
    if region is None:
        return GuardRegion((holds,), (holds,), (fails,), (fails,))
    most, least = clipped(region.may), clipped(region.surely or ())
    if not most:
        return NEVER_HOLDS
    return GuardRegion(
        intersection((holds,), most, sure=False),
        union([(holds,), least], sure=True),
        intersection((fails,), _opposite(least, sure=False), sure=False),
        union([(fails,), _opposite(most, sure=True)], sure=True),
    )


def _exact(boxes: Boxes) -> GuardRegion:
    holds = clipped(boxes)
    return GuardRegion(
        holds, holds, _opposite(holds or boxes, sure=False), _opposite(holds or boxes, sure=True)
    )


def _opposite(boxes: Boxes, *, sure: bool) -> Boxes:
    if len(boxes) == 1:
        return outside(boxes[0])
    found: Boxes = EVERYWHERE
    for box in boxes:
        found = intersection(found, outside(box), sure=sure)
    return found


def _negated(truth: GuardRegion) -> GuardRegion:
    return GuardRegion(truth.may_not, truth.surely_not, truth.may, truth.surely)


def _all(parts: list[GuardRegion]) -> GuardRegion:
    may, surely = EVERYWHERE, EVERYWHERE
    for part in parts:
        may = intersection(may, part.may, sure=False)
        surely = intersection(surely, part.surely, sure=True)
    return GuardRegion(
        may,
        surely,
        union((part.may_not for part in parts), sure=False),
        union((part.surely_not for part in parts), sure=True),
    )


def _variables(tree: StateTree) -> Iterator[tuple[str, Quantity]]:
    """Yield each variable with the values that the mission can give it."""
    given: dict[str, list[Assign]] = {}
    for action in actions_of(tree.mission):
        if isinstance(action, Assign):
            given.setdefault(action.variable, []).append(action)
    words: dict[str, set[str]] = {}
    for guard in tree.compared():
        words.setdefault(guard.name, set()).add(str(guard.value))
    for name, variable in tree.mission.variables.items():
        yield name, _quantity(name, variable, given.get(name, []), words.get(name, set()))


def _quantity(name: str, variable: Variable, given: list[Assign], compared: set[str]) -> Quantity:
    if isinstance(variable.initial, str):
        words = tuple(sorted(compared | {str(variable.initial)}))
        others = () if not given else ("another string",)
        most = float(len(words) + len(others) - 1)
        return Quantity(name, 0.0, most, whole=True, words=(*words, *others))
    least, most = _range(variable, given)
    return Quantity(name, least, most, whole=not isinstance(variable.initial, float))


def _range(variable: Variable, given: Iterable[Assign]) -> tuple[float, float]:
    first = float(variable.initial)
    least = most = first
    for each in given:
        operand = each.operand
        if each.operation == "set" and isinstance(operand, bool | int | float):
            least, most = min(least, operand), max(most, operand)
        elif each.operation == "add" and is_number(operand):
            least, most = (least, math.inf) if operand >= 0 else (-math.inf, most)
        elif isinstance(variable.initial, bool):
            least, most = 0.0, 1.0
        else:
            least, most = -math.inf, math.inf
    low = -math.inf if variable.min is None else variable.min
    high = math.inf if variable.max is None else variable.max
    return max(least, low), min(most, high)
