"""Names of an included file, with the including state's name in front: `land/approach`.

Works on the data as read, so that every name keeps its place. What is not as it should be is left
alone: the model finds it there.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from missionkit.chart.text.located_data import LocatedList, LocatedTable, Text

DONE_EVENT = "done.state."
READING = ("matrix", "rows")  # parameters of guards that read others
VISITED = "visited"  # the guard whose parameter `state` names one
Change = Callable[[Any], Any]


@dataclass(frozen=True, slots=True)
class Renaming:
    """The names that a file defines, which get the prefix; all others mean what is outside."""

    prefix: str
    states: frozenset[str]
    guards: frozenset[str]
    variables: frozenset[str]

    def state(self, data: Any) -> Any:
        """Rename in a state."""
        return _changed(data, self._state_keys())

    def tree(self, data: Any) -> Any:
        """Rename in `states:`, keys and all."""
        return _rekeyed(_each(data, self.state), self._state_name)

    def guard_section(self, data: Any) -> Any:
        """Rename in `guards:`."""
        return _rekeyed(_each(data, self.guard), self._guard_name)

    def variable_section(self, data: Any) -> Any:
        """Rename in `variables:`."""
        return _rekeyed(data, self._variable_name)

    def requirements(self, data: Any) -> Any:
        """Rename in `requirements:`; each gets the prefix itself."""
        keys: dict[str, Change] = {
            **dict.fromkeys(("always", "while"), self.guard),
            **dict.fromkeys(("never", "existence", "precedence"), self._moment),
            **dict.fromkeys(("after", "before"), self._moment),
            "name": self._own_name,
            "response": lambda it: _changed(it, {"when": self._moment, "then": self._moment}),
            "broken": lambda it: _changed(it, {"to": self._state_name}),
        }
        return _each(data, lambda each: _changed(each, keys))

    def _own_name(self, data: Any) -> Any:
        return _prefixed(data, frozenset((data,)), self.prefix) if isinstance(data, str) else data

    def _moment(self, data: Any) -> Any:
        """Rename in a guard, or in `{enter: state}`."""
        enters = isinstance(data, LocatedTable) and "enter" in data and "hysteresis" not in data
        return _changed(data, {"enter": self._state_name}) if enters else self.guard(data)

    def guard(self, data: Any) -> Any:
        """Rename in a guard expression."""
        if isinstance(data, Text):
            return self._guard_name(data)
        inner: dict[str, Change] = {
            "all": lambda parts: _each(parts, self.guard),
            "any": lambda parts: _each(parts, self.guard),
            "not": self.guard,
            "hysteresis": self.guard,
            "in": self._state_name,
            "variable": self._variable_name,
        }
        if isinstance(data, LocatedTable) and "use" in data:
            by_name: dict[str, Change] = {"where": lambda guards: _each(guards, self._guard_name)}
            if data["use"] == VISITED:
                by_name["state"] = self._state_name
            return _changed(data, {**dict.fromkeys(READING, self._read), **by_name})
        return _changed(data, inner)

    def _read(self, data: Any) -> Any:
        """Rename what the parameters of a guard read: `{guard: near}`, `{variable: tries}`."""
        changed = _each(data, self._read)
        return _changed(changed, {"guard": self._guard_name, "variable": self._variable_name})

    def _state_keys(self) -> dict[str, Change]:
        return {
            "states": self.tree,
            "initial": self._start,
            "default": self._start,
            "transitions": lambda ways: _each(ways, self._transition),
            "behavior": lambda it: _each(it, self._parameter),
            "entry": self._actions,
            "exit": self._actions,
            "invariant": lambda it: _changed(it, {"holds": self.guard, "exit": self._state_name}),
        }

    def _parameter(self, data: Any) -> Any:
        """Rename in the value of a behaviour's parameter: `{variable: tries}`."""
        return _changed(data, {"variable": self._variable_name})

    def _transition(self, data: Any) -> Any:
        keys = {"to": self._names, "when": self.guard, "event": self._events, "do": self._actions}
        return _changed(data, keys)

    def _start(self, data: Any) -> Any:
        if isinstance(data, LocatedTable):
            return _changed(data, {"to": self._names, "do": self._actions})
        return self._names(data)

    def _names(self, data: Any) -> Any:
        return (
            _each(data, self._state_name)
            if isinstance(data, LocatedList)
            else self._state_name(data)
        )

    def _events(self, data: Any) -> Any:
        return _each(data, self._event) if isinstance(data, LocatedList) else self._event(data)

    def _event(self, data: Any) -> Any:
        if isinstance(data, Text) and data.startswith(DONE_EVENT):
            name = self._state_name(Text(data.removeprefix(DONE_EVENT), data.place))
            return Text(DONE_EVENT + name, data.place)
        return data

    def _actions(self, data: Any) -> Any:
        return _each(data, lambda action: _changed(action, {"assign": self._assign}))

    def _assign(self, data: Any) -> Any:
        copied = _each(data, lambda value: _changed(value, {"copy": self._variable_name}))
        return _rekeyed(copied, self._variable_name)

    def _state_name(self, data: Any) -> Any:
        return _prefixed(data, self.states, self.prefix)

    def _guard_name(self, data: Any) -> Any:
        return _prefixed(data, self.guards, self.prefix)

    def _variable_name(self, data: Any) -> Any:
        return _prefixed(data, self.variables, self.prefix)


def _prefixed(data: Any, names: frozenset[str], prefix: str) -> Any:
    if not isinstance(data, str) or data not in names:
        return data
    name = f"{prefix}/{data}"
    return Text(name, data.place) if isinstance(data, Text) else name


def _changed(data: Any, keys: Mapping[str, Change]) -> Any:
    """Return a mapping with the values of some keys changed."""
    if not isinstance(data, LocatedTable):
        return data
    table = LocatedTable(data.place)
    for key, value in data.items():
        new = keys[key](value) if key in keys else value
        table.put(key, new, data.key_places[key], data.value_places[key])
    return table


def _rekeyed(data: Any, rename: Change) -> Any:
    if not isinstance(data, LocatedTable):
        return data
    table = LocatedTable(data.place)
    for key, value in data.items():
        table.put(rename(key), value, data.key_places[key], data.value_places[key])
    return table


def _each(data: Any, change: Change) -> Any:
    """Return a list or mapping with every item changed."""
    if isinstance(data, LocatedTable):
        return _changed(data, dict.fromkeys(data, change))
    if not isinstance(data, LocatedList):
        return data
    row = LocatedList(data.place)
    for item, place in zip(data, data.value_places, strict=True):
        row.put(change(item), place)
    return row
