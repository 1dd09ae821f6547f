"""Ways out of the copies of a state with `for_each`: to the next one, to the same one again."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any, NamedTuple

from missionkit.chart.text.located_data import LocatedList, LocatedTable, Text
from missionkit.chart.text.parameter_expansion import LOOP
from missionkit.chart.text.table_edits import row_of, table_of, with_value
from missionkit.errors import Place, Problem

RETRIES = "retries"
SKIP, RETRY = "skip", "retry"


class Loop(NamedTuple):
    """A state with `for_each`, and where a copy of it leads."""

    name: str
    retries: int
    here: str = ""
    after: str = ""

    def counter(self, what: str) -> str:
        """Return the name of one of its variables."""
        return f"{self.name}/{what}"


def led_on(states: Any, loop: Loop, problems: list[Problem]) -> Any:
    """Return states in which `skip` and `retry` are replaced by where they lead.

    Args:
        states: of one copy.
        loop: of the copy that it stands in.
        problems: added to.
    """
    if not isinstance(states, LocatedTable):
        return states
    table = LocatedTable(states.place)
    for name, state in states.items():
        new = state
        if isinstance(state, LocatedTable):
            ways = state.get("transitions")
            if isinstance(ways, LocatedList):
                every = [way for it in ways for way in ways_of(it, loop, problems)]
                new = with_value(new, "transitions", row_of(ways.place, every))
            if "states" in new:
                new = with_value(new, "states", led_on(new["states"], loop, problems))
        table.put(name, new, states.key_places[name], states.value_places[name])
    return table


def ways_of(way: Any, loop: Loop, problems: list[Problem]) -> Iterator[Any]:
    """Yield a transition, or those that `skip` or `retry` stands for.

    Args:
        way: as written.
        loop: of the copy that it stands in.
        problems: added to.
    """
    if not leads_on(way):
        yield way
        return
    place = way.place_of("to")
    given = way.get("do")
    before = list(given) if isinstance(given, LocatedList) else []
    skipped = row_of(place, [*before, *moving_on(loop, "skipped", place)])
    onwards = with_value(with_value(way, "to", Text(loop.after, place)), "do", skipped)
    if way["to"] == SKIP:
        yield onwards
        return
    if loop.retries == 0:
        says = f"to: {RETRY} needs '{RETRIES}: N' beside '{LOOP}'"
        problems.append(Problem(place, says))
    tries = loop.counter("tries")
    again = [*before, _added(tries, place)]
    back = with_value(with_value(way, "to", Text(loop.here, place)), "do", row_of(place, again))
    yield _when(back, table_of(place, variable=Text(tries, place), below=loop.retries))
    yield _when(onwards, table_of(place, variable=Text(tries, place), at_least=loop.retries))


def leads_on(way: object) -> bool:
    """Say whether a transition is one of a copy: `to: skip` or `to: retry`."""
    return isinstance(way, LocatedTable) and way.get("to") in (SKIP, RETRY)


def moving_on(loop: Loop, what: str, place: Place) -> list[LocatedTable]:
    """Return the actions on the way to the next copy.

    Args:
        loop: whose variables count.
        what: `done` or `skipped`.
        place: for messages.
    """
    return [_added(loop.counter(what), place), assigned(loop.counter("tries"), 0, place)]


def _when(way: LocatedTable, more: LocatedTable) -> LocatedTable:
    """Return a transition that waits for one more guard."""
    given = way.get("when")
    both = more if given is None else table_of(more.place, all=row_of(more.place, [given, more]))
    return with_value(way, "when", both, more.place, more.place)


def assigned(name: str, value: object, place: Place) -> LocatedTable:
    """Return the action that sets a variable.

    Args:
        name: of the variable.
        value: or an operation.
        place: for messages.
    """
    it = LocatedTable(place).extended(name, value, place)
    return table_of(place, assign=it)


def _added(name: str, place: Place) -> LocatedTable:
    return assigned(name, table_of(place, add=1), place)
