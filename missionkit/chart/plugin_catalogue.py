"""Catalogue of the plug-ins, by kind, and of the kinds of state.

There is no registry: the command line builds one catalogue and hands it down.
"""

from __future__ import annotations

from collections import ChainMap
from collections.abc import Iterable, Mapping, MutableMapping
from dataclasses import dataclass, field, replace
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any, cast

from pydantic import BaseModel

from missionkit.chart.plugin_check import checked, grouped
from missionkit.chart.plugin_file import plugins_of
from missionkit.chart.plugin_groups import PLUGIN_GROUPS
from missionkit.errors import UsageError
from missionkit.import_on_demand import ImportedOnDemand
from missionkit.plugin import Plugin
from missionkit.plugin_containment import PluginError, reporting_faults
from missionkit.states import VEHICLES
from missionkit.states.contract import StateKind
from missionkit.states.multicopter import MULTICOPTER
from missionkit.states.vehicle_kind import VehicleKind

Plugins = Mapping[str, type[Plugin]]


@dataclass(frozen=True)
class Catalogue:
    """Plug-in classes and state kinds by the name that mission files use."""

    plugins: Mapping[str, Plugins]  # by group
    vehicle: VehicleKind = MULTICOPTER  # what the mission is for
    broken: Mapping[tuple[str, str], str] = field(default_factory=dict)  # group, name -> why

    @property
    def kinds(self) -> Mapping[str, StateKind]:
        """The kinds of state of the vehicle."""
        return self.vehicle.kinds

    def flying(self, vehicle: object) -> Catalogue:
        """Return the catalogue for missions of a kind of vehicle, by its name."""
        known = VEHICLES.get(str(vehicle), MULTICOPTER)
        return self if known is self.vehicle else replace(self, vehicle=known)

    def group(self, name: str) -> Plugins:
        """Return the plug-ins of one of `PLUGIN_GROUPS`."""
        return self.plugins[name]

    def extended(self, group: str, plugins: Iterable[type[Plugin]]) -> Catalogue:
        """Return a catalogue with more plug-ins.

        Raises:
            UsageError: a kind is taken; names both sources.
        """
        known, added = self.group(group), dict[str, type[Plugin]]()
        for plugin in plugins:
            taken = added.get(plugin.kind) or known.get(plugin.kind)
            if taken is not None and taken is not plugin:
                raise UsageError(
                    f"two {group} are called {plugin.kind!r}: {source(taken)} and {source(plugin)}"
                )
            added[plugin.kind] = plugin
        return self._with(group, ChainMap(added, cast(MutableMapping[str, type[Plugin]], known)))

    def with_entry_points(self) -> Catalogue:
        """Return a catalogue with the plug-ins of installed packages.

        One that cannot be used does no harm to missions that do not use it: it is in `broken`.
        """
        catalogue = self
        installed = entry_points()  # once: it reads the folders of all packages
        for group in PLUGIN_GROUPS:
            for entry in installed.select(group=f"missionkit.{group}"):
                catalogue = catalogue._with_entry(group, entry)
        return catalogue

    def _with_entry(self, group: str, entry: EntryPoint) -> Catalogue:
        try:
            return self.extended(group, [_loaded(group, entry)])
        except UsageError as error:
            broken = {**self.broken, (group, entry.name): str(error)}
            taken = self.group(group).get(entry.name)
            if taken is None or taken.__module__.startswith("missionkit."):
                return replace(self, broken=broken)
            others = {k: it for k, it in self.group(group).items() if it is not taken}
            return replace(self._with(group, others), broken=broken)

    def with_file(self, path: Path) -> Catalogue:
        """Return a catalogue with the plug-ins of every group that a Python file defines.

        Raises:
            FileError: the file cannot be imported, or defines none or one that is incomplete.
            UsageError: a name is taken.
        """
        catalogue = self
        for group, plugin in plugins_of(path):
            catalogue = catalogue.extended(group, [plugin])
        return catalogue

    def with_class(self, plugin: type[BaseModel]) -> Catalogue:
        """Return a catalogue with one more plug-in class, in the group that it fits.

        Raises:
            UsageError: it fits none or several, or its name is taken.
        """
        group, checked_class = grouped(plugin)
        return self.extended(group, [checked_class])

    def _with(self, group: str, plugins: Plugins) -> Catalogue:
        return replace(self, plugins={**self.plugins, group: plugins})


def source(plugin: type[Plugin]) -> str:
    """Say where a plug-in comes from."""
    return f"{plugin.__module__}.{plugin.__qualname__}"


def builtin() -> Catalogue:
    """Return the catalogue of what missionkit itself brings."""
    return Catalogue(
        plugins={
            name: ImportedOnDemand(group.builtin, _as_class)
            for name, group in PLUGIN_GROUPS.items()
        },
    )


def _as_class(_: str, found: object) -> type[Plugin]:
    return cast(type[Plugin], found)


def _loaded(group: str, entry: EntryPoint) -> type[Plugin]:
    try:
        with reporting_faults():
            plugin: Any = entry.load()
    except PluginError as error:
        raise UsageError(f"{entry.value} cannot be imported: {error}") from error
    try:
        return checked(plugin, group)
    except UsageError as error:
        raise UsageError(f"{entry.value} cannot be used: {error}") from None
