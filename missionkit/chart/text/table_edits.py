"""Copies of tables and lists with something added, replaced or left out; places are kept."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from missionkit.chart.text.located_data import LocatedList, LocatedTable, Text, place_of
from missionkit.errors import Place


def with_value(
    table: LocatedTable,
    key: str,
    value: Any,
    key_place: Place | None = None,
    at: Place | None = None,
) -> LocatedTable:
    """Return a copy with one value replaced or added, unless there is nothing to add.

    Args:
        table: stays as it is.
        key: of the value.
        value: None adds nothing.
        key_place: for messages about the key.
        at: for messages about the value.
    """
    if value is None and key not in table:
        return table
    copy = without(table, ())
    key_place = key_place or table.key_places.get(key, table.place)
    copy.put(key, value, key_place, at or table.value_places.get(key, place_of(value)))
    return copy


def without(table: LocatedTable, keys: tuple[str, ...]) -> LocatedTable:
    """Return a copy without some keys."""
    copy = LocatedTable(table.place)
    for key, value in table.items():
        if key not in keys:
            copy.put(key, value, table.key_places[key], table.value_places[key])
    return copy


def merged(one: Any, other: Mapping[str, Any]) -> Any:
    """Return a mapping with the entries of another added; anything but a mapping stays as it is."""
    if not other or not (one is None or isinstance(one, LocatedTable)):
        return one
    table = LocatedTable(place_of(other)) if one is None else without(one, ())
    if isinstance(other, LocatedTable):
        for key, value in other.items():
            table.put(key, value, other.key_places[key], other.value_places[key])
    return table


def together(one: LocatedList, other: Any) -> Any:
    """Return the items of two lists; of the second nothing if it is not a list."""
    row = LocatedList(one.place)
    for each in (one, other if isinstance(other, LocatedList) else LocatedList(one.place)):
        for item, place in zip(each, each.value_places, strict=True):
            row.put(item, place)
    return row


def table_of(place: Place, **values: object) -> LocatedTable:
    """Return a mapping that is written nowhere, as if at `place`."""
    table = LocatedTable(place)
    for key, value in values.items():
        table.put(key, Text(value, place) if isinstance(value, str) else value, place, place)
    return table


def row_of(place: Place, items: list[Any]) -> LocatedList:
    """Return a list that is written nowhere; its items keep their places."""
    row = LocatedList(place)
    for item in items:
        row.put(item, place_of(item) if isinstance(item, LocatedTable) else place)
    return row
