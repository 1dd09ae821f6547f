"""Plain data that remembers where it stood in its file."""

from __future__ import annotations

from typing import Any

from typing_extensions import override

from missionkit.errors import Place

FILE_START = Place("", 1, 1)


class Text(str):
    """A string and where it was written."""

    __slots__ = ("place",)

    place: Place

    def __new__(cls, value: str, place: Place) -> Text:
        """Return `value`, remembering `place`."""
        text = super().__new__(cls, value)
        text.place = place
        return text

    @override
    def __reduce__(self) -> tuple[type[Text], tuple[str, Place]]:
        """Return how to make it again, so that a mission can be saved."""
        return Text, (str(self), self.place)


class LocatedTable(dict[str, Any]):
    """A mapping with the place of itself, of each key and of each value."""

    __slots__ = ("key_places", "place", "value_places")

    def __init__(self, place: Place) -> None:
        super().__init__()
        self.place = place
        self.key_places: dict[str, Place] = {}
        self.value_places: dict[str, Place] = {}

    def put(self, key: str, value: object, key_place: Place, value_place: Place) -> None:
        """Add an entry.

        Args:
            key: as written.
            value: plain data or another `LocatedTable` or `LocatedList`.
            key_place: for messages about the key.
            value_place: for messages about the value.
        """
        self[key] = value
        self.key_places[key] = key_place
        self.value_places[key] = value_place

    def extended(self, key: str, value: object, place: Place) -> LocatedTable:
        """Return a copy with one more entry.

        Args:
            key: as if it had been written.
            value: plain data.
            place: for messages about key and value.
        """
        table = LocatedTable(self.place)
        table.update(self)
        table.key_places.update(self.key_places)
        table.value_places.update(self.value_places)
        table.put(key, value, place, place)
        return table

    def place_of(self, key: str) -> Place:
        """Return where the value of `key` stands, or the mapping itself when it has no such key."""
        return self.value_places.get(key, self.place)


class LocatedList(list[Any]):
    """A list with the place of itself and of each item."""

    __slots__ = ("place", "value_places")

    def __init__(self, place: Place) -> None:
        super().__init__()
        self.place = place
        self.value_places: list[Place] = []

    def put(self, value: object, place: Place) -> None:
        """Add an item."""
        self.append(value)
        self.value_places.append(place)


def place_of(data: object) -> Place:
    """Return where a mapping, list or text stands; other data does not know."""
    return data.place if isinstance(data, (LocatedTable, LocatedList, Text)) else FILE_START


def place_at(data: object, path: tuple[int | str, ...], root: Place) -> Place:
    """Return where the value at `path` stands, or its nearest container that is written down.

    Args:
        data: root of the document.
        path: keys and indices from the root.
        root: returned for what is not in the text at all.
    """
    place = root
    for step in path:
        if isinstance(data, LocatedTable) and isinstance(step, str):
            place = data.value_places.get(step, place)
        elif isinstance(data, LocatedList) and isinstance(step, int) and step < len(data):
            place = data.value_places[step]
        data = _child(data, step)
    return place


def written_path(data: object, path: tuple[int | str, ...]) -> tuple[int | str, ...]:
    """Return `path` without the steps that name alternatives of a type, not keys of the data.

    The last step stays where a mapping or list could have it: a missing key is also somewhere.
    """
    kept: list[int | str] = []
    for at, step in enumerate(path):
        inside = isinstance(data, dict) if isinstance(step, str) else isinstance(data, list)
        if inside and (at == len(path) - 1 or _child(data, step) is not data):
            kept.append(step)
            data = _child(data, step)
    return tuple(kept)


def key_at(data: object, path: tuple[int | str, ...], root: Place) -> Place:
    """Return where the key that ends `path` stands.

    Args:
        data: root of the document.
        path: keys and indices from the root, not empty.
        root: returned for what is not in the text at all.
    """
    table = value_at(data, path[:-1])
    if isinstance(table, LocatedTable) and path[-1] in table:
        return table.key_places[str(path[-1])]
    return place_at(data, path, root)


def value_at(data: object, path: tuple[int | str, ...]) -> object:
    """Return the value at `path`, skipping steps that are not keys of the data."""
    for step in path:
        data = _child(data, step)
    return data


def _child(data: object, step: int | str) -> object:
    if isinstance(data, dict):
        return data.get(step, data)
    if isinstance(data, list) and isinstance(step, int) and step < len(data):
        return data[step]
    return data


def shown(value: object) -> str:
    """Return a value as a message quotes it."""
    if isinstance(value, dict):
        return "a mapping"
    if isinstance(value, (list, tuple)):
        return "a list"
    if value is None:
        return "nothing"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, str) and len(value) > 60:
        return repr(value[:57] + "...")
    return repr(value)
