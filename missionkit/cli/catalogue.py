"""Assembling what missions may use: built-ins, installed packages, files named on the way."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

from missionkit.chart.plugin_catalogue import Catalogue, builtin
from missionkit.errors import UsageError


def assemble(files: Iterable[Path] = ()) -> Catalogue:
    """Return the catalogue.

    Raises:
        FileError: a plug-in file cannot be used.
        UsageError: a plug-in cannot be imported, or a name is taken twice.
    """
    catalogue = builtin().with_entry_points()
    for path in files:
        catalogue = catalogue.with_file(path)
    return catalogue


def overrides(settings: Iterable[str]) -> dict[str, str]:
    """Read `--set NAME=VALUE` options.

    Raises:
        UsageError: one has no `=`.
    """
    pairs = [setting.partition("=") for setting in settings]
    for name, equals, value in pairs:
        if not (name and equals):
            raise UsageError(f"--set {name}{equals}{value}: expected NAME=VALUE, as in cruise=4")
    return {name: value for name, _, value in pairs}
