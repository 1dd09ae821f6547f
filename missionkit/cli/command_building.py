"""Commands that are imported and built when they are called, so that none waits for the others."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from importlib import import_module
from typing import Any

import typer
from typing_extensions import override

from missionkit.cli.command_options import reporting_errors


class CommandsOnDemand(Mapping[str, Any]):
    """Commands of the command-line library by name."""

    def __init__(self, places: Mapping[str, str]) -> None:
        """Take where each command is.

        Args:
            places: name -> `module.function` in this package, or `module.app` of a `typer.Typer`.
        """
        self._places = places
        self._built: dict[str, Any] = {}

    @override
    def __getitem__(self, name: str) -> Any:
        if name not in self._built:
            module, _, attribute = self._places[name].rpartition(".")
            found = getattr(import_module(f"missionkit.cli.{module}"), attribute)
            self._built[name] = _built(name, found)
        return self._built[name]

    @override
    def __iter__(self) -> Iterator[str]:
        return iter(self._places)

    @override
    def __len__(self) -> int:
        return len(self._places)


def _built(name: str, found: Any) -> Any:
    if isinstance(found, typer.Typer):
        group = typer.main.get_command(found)
        group.name = name
        return group
    alone = typer.Typer(add_completion=False, rich_markup_mode=None, pretty_exceptions_enable=False)
    alone.command(name)(reporting_errors(found))
    return typer.main.get_command(alone)
