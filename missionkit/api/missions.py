"""Missions from Python: a file, the plug-ins it may use and the parameters it is flown with."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

from pydantic import BaseModel

from missionkit.chart import load as reading
from missionkit.chart.checks import findings
from missionkit.chart.model.mission import Mission
from missionkit.chart.model.state_contracts import unmet
from missionkit.chart.plugin_catalogue import Catalogue, builtin
from missionkit.errors import FileError, Level

NO_SETTINGS: Mapping[str, object] = MappingProxyType({})


@dataclass(frozen=True)
class LoadedMission:
    """A mission that was read and checked, with everything it flies with.

    Attributes:
        model: the mission file as a model.
        catalogue: the plug-ins and kinds of state that it may use.
        path: of the file.
        settings: parameters that override those of the file, in YAML.
        plugins: files and classes of plug-ins in addition to the installed ones.

    Example:
        >>> mission.name, mission.states
        ('first-flight', ('idle', 'out', 'back', 'land'))
    """

    model: Mission
    catalogue: Catalogue
    path: Path
    settings: Mapping[str, str]
    plugins: tuple[Path | type[BaseModel], ...]

    @property
    def name(self) -> str:
        """The mission's name."""
        return self.model.name

    @property
    def parameters(self) -> Mapping[str, Any]:
        """The parameters by name, with their effective values."""
        return self.model.params

    @property
    def states(self) -> tuple[str, ...]:
        """The names of all states, in the order of the file."""
        return tuple(self.model.by_name())

    @property
    def targets(self) -> tuple[str, ...]:
        """The names of the targets, in the order of the file."""
        return tuple(self.model.targets)


def load(
    path: str | Path,
    *,
    settings: Mapping[str, object] = NO_SETTINGS,
    plugins: Sequence[str | Path | type[BaseModel]] = (),
) -> LoadedMission:
    """Read a mission file and refuse it if it has errors.

    Args:
        path: path of the YAML file, quoted in messages as given here.
        settings: values of the mission's `params` by name. A text is read as YAML, as `--set`
            reads it; numbers, lists and booleans are taken as they are.
        plugins: plug-in classes, or Python files that define them, besides the installed ones.

    Returns:
        The mission, ready for `rehearse`, `fly` and `campaign`.

    Raises:
        FileError: the file, the world or map it names, or a plug-in file cannot be used; lists
            every error with line and column. Warnings do not refuse a mission: see `validate`.
        UsageError: two plug-ins have the same name, or a class cannot be a plug-in.

    Example:
        >>> mission = missionkit.load("mission.yaml", settings={"height": 3})
        >>> mission.parameters
        {'cruise': 4.0, 'height': 3}
    """
    catalogue = assemble(plugins)
    values = as_yaml(settings)
    model = reading.load(Path(path), catalogue, values)
    refuse(model, catalogue)
    return LoadedMission(
        model,
        catalogue,
        Path(path),
        values,
        tuple(Path(it) if isinstance(it, str) else it for it in plugins),
    )


def as_yaml(settings: Mapping[str, object]) -> dict[str, str]:
    """Return values of parameters as the command line would write them."""
    return {
        name: value if isinstance(value, str) else json.dumps(value)
        for name, value in settings.items()
    }


def assemble(plugins: Iterable[str | Path | type[BaseModel]] = ()) -> Catalogue:
    """Return what missions may use: built-ins, installed packages, files and classes.

    Raises:
        FileError: a plug-in file cannot be used.
        UsageError: a class cannot be a plug-in, or a name is taken twice.
    """
    catalogue = builtin().with_entry_points()
    for plugin in plugins:
        if isinstance(plugin, str | Path):
            catalogue = catalogue.with_file(Path(plugin))
        else:
            catalogue = catalogue.with_class(plugin)
    return catalogue


def refuse(mission: Mission, catalogue: Catalogue) -> None:
    """Refuse a mission with errors; `validate` lists its warnings too.

    Raises:
        FileError: the contracts of its states are not met, or its chart cannot be right.
    """
    problems = unmet(mission, catalogue) or findings(mission, catalogue)
    if errors := [problem for problem in problems if problem.level is Level.ERROR]:
        raise FileError(errors)
