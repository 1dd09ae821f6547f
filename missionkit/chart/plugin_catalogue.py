"""Catalogue of the plug-ins, by kind, and of the kinds of state.

There is no registry: the command line builds one catalogue and hands it down.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from importlib.metadata import EntryPoint, entry_points
from pathlib import Path
from typing import Any, cast

from missionkit.behaviors import ALL as BEHAVIORS
from missionkit.chart.plugin_check import wrong_with
from missionkit.chart.plugin_file import plugins_of
from missionkit.errors import UsageError
from missionkit.estimation.error_state_ekf.parameters import VisualInertialEkf
from missionkit.estimation.optical_flow.flow_parameters import FlowKalman
from missionkit.guards import ALL as GUARDS
from missionkit.perception.aruco import Aruco
from missionkit.planning.potential_field import PotentialField
from missionkit.plugin import Plugin
from missionkit.plugin_containment import PluginError, reporting_faults
from missionkit.states import KINDS
from missionkit.states.contract import StateKind

Plugins = Mapping[str, type[Plugin]]
GROUPS = ("guards", "behaviors", "navigators", "detectors", "planners")


@dataclass(frozen=True)
class Catalogue:
    """Plug-in classes and state kinds by the name that mission files use."""

    guards: Plugins
    behaviors: Plugins
    navigators: Plugins
    detectors: Plugins
    planners: Plugins
    kinds: Mapping[str, StateKind]
    broken: Mapping[tuple[str, str], str] = field(default_factory=dict)  # group, name -> why

    def group(self, name: str) -> Plugins:
        """Return the plug-ins of one of `GROUPS`."""
        plugins: Plugins = getattr(self, name)
        return plugins

    def extended(self, group: str, plugins: Iterable[type[Plugin]]) -> Catalogue:
        """Return a catalogue with more plug-ins.

        Raises:
            UsageError: a kind is taken; names both sources.
        """
        known = dict(self.group(group))
        for plugin in plugins:
            taken = known.get(plugin.kind)
            if taken is not None and taken is not plugin:
                raise UsageError(
                    f"two {group} are called {plugin.kind!r}: {source(taken)} and {source(plugin)}"
                )
            known[plugin.kind] = plugin
        return replace(self, **cast(dict[str, Any], {group: known}))

    def with_entry_points(self) -> Catalogue:
        """Return a catalogue with the plug-ins of installed packages.

        One that cannot be used does no harm to missions that do not use it: it is in `broken`.
        """
        catalogue = self
        for group in GROUPS:
            for entry in entry_points(group=f"missionkit.{group}"):
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
            return replace(self, broken=broken, **cast(dict[str, Any], {group: others}))

    def with_file(self, path: Path) -> Catalogue:
        """Return a catalogue with the guards, behaviours and detectors that a Python file defines.

        Raises:
            FileError: the file cannot be imported or defines no complete plug-in.
            UsageError: a name is taken.
        """
        catalogue = self
        for plugin in plugins_of(path):
            catalogue = catalogue.with_class(plugin)
        return catalogue

    def with_class(self, plugin: type[Plugin]) -> Catalogue:
        """Return a catalogue with one more plug-in class, in the group that it fits.

        Raises:
            UsageError: it fits none, or its name is taken.
        """
        wrong = {group: wrong_with(group, plugin) for group in GROUPS}
        fitting = [group for group in GROUPS if not wrong[group]]
        if not fitting:
            raise UsageError(f"{plugin!r} cannot be a plug-in: {wrong[GROUPS[0]]}")
        return self.extended(fitting[0], [plugin])


def source(plugin: type[Plugin]) -> str:
    """Say where a plug-in comes from."""
    return f"{plugin.__module__}.{plugin.__qualname__}"


def builtin() -> Catalogue:
    """Return the catalogue of what missionkit itself brings."""
    return Catalogue(
        guards=_by_kind(GUARDS),
        behaviors=_by_kind(BEHAVIORS),
        navigators=_by_kind((FlowKalman, VisualInertialEkf)),
        detectors=_by_kind((Aruco,)),
        planners=_by_kind((PotentialField,)),
        kinds=KINDS,
    )


def _by_kind(plugins: Iterable[type[Plugin]]) -> Plugins:
    return {plugin.kind: plugin for plugin in plugins}


def _loaded(group: str, entry: EntryPoint) -> type[Plugin]:
    try:
        with reporting_faults():
            plugin: Any = entry.load()
    except PluginError as error:
        raise UsageError(f"{entry.value} cannot be imported: {error}") from error
    if wrong := wrong_with(group, plugin):
        raise UsageError(f"{entry.value} cannot be used: {wrong}")
    return cast(type[Plugin], plugin)
