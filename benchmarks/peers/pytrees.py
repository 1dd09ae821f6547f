"""py_trees: a behaviour tree that keeps a state, since it has no charts."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

from py_trees.behaviour import Behaviour
from py_trees.behaviours import Success
from py_trees.common import Status
from py_trees.composites import Selector, Sequence

from benchmarks.peers.ring import Engine, Guards, Machine, Ring, Sky, Way


class Leaf(Behaviour):
    """Succeeds when a function says so."""

    def __init__(self, name: str, function: Callable[[], bool]) -> None:
        super().__init__(name)
        self.function = function

    def update(self) -> Status:
        return Status.SUCCESS if self.function() else Status.FAILURE


class Place:
    """The state."""

    def __init__(self, name: str) -> None:
        self.name = name

    def at(self, name: str) -> bool:
        return self.name == name

    def go(self, name: str) -> bool:
        self.name = name
        return True


def load(chart: Ring, _: Sky, guards: Guards) -> Machine:
    """Build the tree: the first state that is the current one; in it the first guard that holds."""
    place = Place(chart.initial)
    states = [_state(name, ways, place, guards) for name, ways in chart.states.items()]
    root = Selector("root", memory=False, children=states)
    return Machine(root.tick_once, lambda: place.name)


def _state(name: str, ways: tuple[Way, ...], place: Place, guards: Guards) -> Behaviour:
    taken = [_taken(way, place, guards) for way in ways]
    choice = Selector("ways", memory=False, children=[*taken, Success("stay")])
    here = Leaf("here", partial(place.at, name))
    return Sequence(name, memory=False, children=[here, choice])


def _taken(way: Way, place: Place, guards: Guards) -> Behaviour:
    children = [Leaf("guard", guards[way.ask.name]), Leaf("go", partial(place.go, way.to))]
    return Sequence(way.to, memory=False, children=children)


HOW = "a selector over states of a selector over guards, `tick_once` at the root; load: objects"
ENGINES = (Engine("py_trees", HOW, lambda chart: chart, load, "py-trees"),)
