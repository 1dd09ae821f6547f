"""Things by name that are imported when one is asked for: the names are known without an import."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from typing import Generic, TypeVar

from typing_extensions import override

T = TypeVar("T")


def imported(place: str) -> object:
    """Return what a module holds.

    Args:
        place: `package.module.attribute`.
    """
    module, _, attribute = place.rpartition(".")
    return getattr(import_module(module), attribute)


class ImportedOnDemand(Mapping[str, T], Generic[T]):
    """A mapping whose values are imported when they are first read."""

    def __init__(self, places: Mapping[str, str], made: Callable[[str, object], T]) -> None:
        """Take where each value is, and what is made of it.

        Args:
            places: name -> `package.module.attribute`.
            made: the value, of a name and of what was imported.
        """
        self._places = places
        self._made = made
        self._values: dict[str, T] = {}

    @override
    def __getitem__(self, name: str) -> T:
        if name not in self._values:
            self._values[name] = self._made(name, imported(self._places[name]))
        return self._values[name]

    @override
    def __contains__(self, name: object) -> bool:
        return name in self._places

    @override
    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    @override
    def __len__(self) -> int:
        return len(self._places)
