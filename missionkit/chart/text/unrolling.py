"""`for_each:`: one state for many things, written out when the mission is loaded.

    poles:
      for_each: {pole: [p1, p2, p3]}
      retries: 1
      states: {go: {..., target: $pole, transitions: [{to: skip, after: 60}]}, seen: {final: true}}
      transitions: [{to: home, when: done}]

The state becomes one that contains a copy of itself for each thing, `poles/p1`, `poles/p2`, …, with
`$pole` replaced, and one after the other: a copy that is done leads to the next one. Inside,
`to: skip` leads to the next one at once, and `to: retry` begins the same one again, `retries` times
before it is skipped. Transitions of the state itself that lead to one of these belong to each copy;
its others to the whole, which is done after the last. The variables `poles/done`, `poles/skipped`
and `poles/tries` count.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

from missionkit.chart.text.include_renaming import Renaming
from missionkit.chart.text.located_data import LocatedList, LocatedTable, Text, place_of, shown
from missionkit.chart.text.loop_transitions import (
    RETRIES,
    Loop,
    assigned,
    leads_on,
    led_on,
    moving_on,
    ways_of,
)
from missionkit.chart.text.parameter_expansion import LOOP, Expanded
from missionkit.chart.text.table_edits import merged, row_of, table_of, with_value, without
from missionkit.errors import Place, Problem

WHOLE_KEYS = ("summary", "entry", "exit")  # of the state around the copies
END = "finished"
MOST_ROUNDS = 100
_LABEL = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")


def unrolled(expanded: Expanded) -> Expanded:
    """Return a document whose states with `for_each` are written out.

    Args:
        expanded: the document, parameters replaced.
    """
    data = expanded.data
    if not isinstance(data, LocatedTable) or not _loops(data.get("states")):
        return expanded
    work = _Unrolling(list(expanded.problems), dict(expanded.origins))
    states = work.states(data["states"])
    counted = merged(data.get("variables"), work.variables)
    data = with_value(with_value(data, "states", states), "variables", counted)
    return replace(expanded, data=data, problems=tuple(work.problems), origins=work.origins)


def _loops(states: object) -> bool:
    if not isinstance(states, LocatedTable):
        return False
    tables = (state for state in states.values() if isinstance(state, LocatedTable))
    return any(LOOP in state or _loops(state.get("states")) for state in tables)


class _Round(NamedTuple):
    """One copy: its name, and what stands for the names of `for_each`."""

    name: str
    values: Mapping[str, Any]


@dataclass(slots=True)
class _Unrolling:
    problems: list[Problem]
    origins: dict[Place, str]
    variables: LocatedTable = field(default_factory=lambda: LocatedTable(Place("", 1, 1)))

    def states(self, data: Any) -> Any:
        """Return `states:` with every loop in it written out."""
        if not isinstance(data, LocatedTable):
            return data
        table = LocatedTable(data.place)
        for name, state in data.items():
            table.put(name, self._state(name, state), data.key_places[name], place_of(state))
        return table

    def _state(self, name: str, state: Any) -> Any:
        if not isinstance(state, LocatedTable):
            return state
        if LOOP not in state:
            inside = self.states(state.get("states"))
            return with_value(state, "states", inside) if "states" in state else state
        rounds = self._rounds(name, state)
        retries = self._retries(state)
        if not rounds:
            return table_of(state.place, kind="logic")
        return self._written_out(Loop(name, retries), state, rounds)

    def _rounds(self, name: str, state: LocatedTable) -> list[_Round]:
        """Return the copies to make, none if the loop is not as it should be."""
        loop, place = state[LOOP], state.place_of(LOOP)
        if not isinstance(loop, LocatedTable) or not loop:
            return self._wrong(place, f"expected a mapping (name: list), got {shown(loop)}")
        for key, values in loop.items():
            if not isinstance(values, LocatedList) or not values:
                what = "an empty list" if values == [] else shown(values)
                says = f"{key!r}: expected a list of what ${key} stands for, got {what}"
                return self._wrong(loop.place_of(key), says)
        counts = {len(values) for values in loop.values()}
        if len(counts) > 1:
            return self._wrong(place, "its lists must be of one length: they go together")
        if max(counts) > MOST_ROUNDS:
            return self._wrong(place, f"at most {MOST_ROUNDS} rounds, got {max(counts)}")
        used = set(_references(without(state, (LOOP,))))
        for key in loop.keys() - used:
            at = loop.key_places[key]
            self._wrong(at, f"{key!r} is never used; write ${key} where it belongs")
        first = next(iter(loop))
        rounds = [dict(zip(loop, row, strict=True)) for row in zip(*loop.values(), strict=True)]
        labels = [str(it[first]) for it in rounds]
        plain = all(isinstance(it[first], str) and _LABEL.fullmatch(it[first]) for it in rounds)
        if not plain or len({*labels, END}) <= len(labels):
            labels = [f"{first}-{count}" for count in range(1, len(rounds) + 1)]
        return [_Round(f"{name}/{it}", row) for it, row in zip(labels, rounds, strict=True)]

    def _wrong(self, place: Place, says: str) -> list[_Round]:
        self.problems.append(Problem(place, f"{LOOP}: {says}"))
        return []

    def _retries(self, state: LocatedTable) -> int:
        given = state.get(RETRIES, 0)
        if isinstance(given, int) and not isinstance(given, bool) and given >= 0:
            return given
        says = f"{RETRIES}: expected a whole number from 0 up, got {shown(given)}"
        self.problems.append(Problem(state.place_of(RETRIES), says))
        return 0

    def _written_out(self, loop: Loop, state: LocatedTable, rounds: list[_Round]) -> LocatedTable:
        place = state.place_of(LOOP)
        ways = state.get("transitions")
        own = [it for it in ways if leads_on(it)] if isinstance(ways, LocatedList) else []
        body = without(state, (LOOP, RETRIES, "transitions", *WHOLE_KEYS))
        states = LocatedTable(place)
        names = [*(it.name for it in rounds), loop.counter(END)]
        for each, after in zip(rounds, names[1:], strict=True):
            here = loop._replace(here=each.name, after=after)
            states.put(each.name, self._copy(here, body, own, each.values), place, place)
        states.put(names[-1], table_of(place, final=True), place, place)
        for what in ("done", "skipped", "tries"):
            most = loop.retries if what == "tries" else len(rounds)
            counter = table_of(place, initial=0, min=0, max=most)
            self.variables.put(loop.counter(what), counter, place, place)
        zero = [assigned(loop.counter(it), 0, place) for it in ("done", "skipped", "tries")]
        begins = table_of(place, to=Text(names[0], place), do=row_of(place, zero))
        whole = _kept(state, WHOLE_KEYS)
        whole = whole.extended("initial", begins, place).extended("states", states, place)
        if not isinstance(ways, LocatedList):
            return whole if ways is None else whole.extended("transitions", ways, place)
        rest = row_of(ways.place, [it for it in ways if not leads_on(it)])
        return whole.extended("transitions", rest, ways.place)

    def _copy(
        self, loop: Loop, body: LocatedTable, own: list[Any], values: Mapping[str, Any]
    ) -> LocatedTable:
        """Return the state for one round."""
        place = body.place
        copy = self._bound(body, values)
        inner = _Unrolling(self.problems, self.origins)
        if "states" in copy:
            copy = with_value(
                copy, "states", led_on(inner.states(copy["states"]), loop, self.problems)
            )
        every = frozenset(_names(copy.get("states")))
        renaming = Renaming(loop.here, every, frozenset(), frozenset(inner.variables))
        renamed: LocatedTable = renaming.state(copy)
        self.variables = merged(self.variables, renaming.variable_section(inner.variables))
        ways = [way for it in own for way in ways_of(self._bound(it, values), loop, self.problems)]
        finished = table_of(
            place,
            to=Text(loop.after, place),
            when=Text("done", place),
            do=row_of(place, moving_on(loop, "done", place)),
        )
        return renamed.extended("transitions", row_of(place, [*ways, finished]), place)

    def _bound(self, data: Any, values: Mapping[str, Any]) -> Any:
        """Return data with each `$name` of the loop replaced."""
        if isinstance(data, LocatedTable):
            table = LocatedTable(data.place)
            for key, item in data.items():
                at = data.value_places[key]
                table.put(key, self._bound(item, values), data.key_places[key], at)
            return table
        if isinstance(data, LocatedList):
            row = LocatedList(data.place)
            for item, at in zip(data, data.value_places, strict=True):
                row.put(self._bound(item, values), at)
            return row
        if isinstance(data, Text) and data[:1] == "$" and data[1:] in values:
            self.origins[data.place] = data[1:]
            found = values[data[1:]]
            return Text(found, data.place) if isinstance(found, str) else found
        return data


def _kept(state: LocatedTable, keys: tuple[str, ...]) -> LocatedTable:
    return without(state, tuple(key for key in state if key not in keys))


def _names(states: object) -> Iterator[str]:
    if isinstance(states, LocatedTable):
        for name, state in states.items():
            yield name
            if isinstance(state, LocatedTable):
                yield from _names(state.get("states"))


def _references(data: object) -> Iterator[str]:
    """Yield each name after a `$`."""
    if isinstance(data, LocatedTable):
        for value in data.values():
            yield from _references(value)
    elif isinstance(data, LocatedList):
        for value in data:
            yield from _references(value)
    elif isinstance(data, Text) and data.startswith("$"):
        yield data[1:]
