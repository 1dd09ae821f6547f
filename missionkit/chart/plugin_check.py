"""Checks plug-in classes before a mission may use them, whatever package they come from."""

from __future__ import annotations

import inspect
from typing import cast

from pydantic import BaseModel
from typing_extensions import get_protocol_members

from missionkit.chart.plugin_groups import PLUGIN_GROUPS
from missionkit.errors import UsageError
from missionkit.import_on_demand import imported
from missionkit.plugin import Plugin

CONFIG = {"frozen": True, "extra": "forbid", "allow_inf_nan": False}


def checked(plugin: object, group: str) -> type[Plugin]:
    """Return a class that can be a plug-in of `group`.

    Raises:
        UsageError: it cannot; says what is missing.
    """
    model = _model(plugin)
    if wrong := _wrong_with(model, group):
        raise UsageError(wrong)
    return model


def grouped(plugin: object) -> tuple[str, type[Plugin]]:
    """Return the group whose contract a class satisfies, and the class.

    Raises:
        UsageError: it satisfies none, or those of several groups.
    """
    model = _model(plugin)
    wrong = {group: _wrong_with(model, group) for group in PLUGIN_GROUPS}
    fitting = [group for group, why in wrong.items() if not why]
    if len(fitting) == 1:
        return fitting[0], model
    if fitting:
        words = " and of a ".join(PLUGIN_GROUPS[group].word for group in fitting)
        raise UsageError(f"{model.__name__} has the methods of a {words}; make it two classes")
    shared = {
        group: len(_members(_contract(model, group)) & _present(model)) for group in PLUGIN_GROUPS
    }
    nearest = max(shared, key=shared.__getitem__)
    if not shared[nearest]:
        words = ", ".join(group.word for group in PLUGIN_GROUPS.values())
        raise UsageError(f"{model.__name__} has no method of a plug-in ({words})")
    raise UsageError(wrong[nearest])


def _model(plugin: object) -> type[Plugin]:
    """Return a class whose parameters a mission file can give."""
    if not isinstance(plugin, type):
        raise UsageError(f"{plugin!r} is not a class")
    name = plugin.__name__
    if not issubclass(plugin, BaseModel):
        bases = "missionkit.Guard or another base class, or from pydantic.BaseModel"
        raise UsageError(f"{name} is not a model of parameters: derive it from {bases}")
    kind = getattr(plugin, "kind", None)
    if not (isinstance(kind, str) and kind):
        raise UsageError(f"{name} has no `kind`, the name that mission files use")
    config = plugin.model_config
    if wrong := [f"{key}={value!r}" for key, value in CONFIG.items() if config.get(key) != value]:
        raise UsageError(f"{name} needs model_config = ConfigDict({', '.join(wrong)})")
    return cast(type[Plugin], plugin)


def _wrong_with(model: type[Plugin], group: str) -> str:
    """Say why a model cannot be a plug-in of a group; "": nothing is wrong."""
    if any(issubclass(model, cast(type, imported(it))) for it in PLUGIN_GROUPS[group].bases):
        return ""
    contract = _contract(model, group)
    missing = sorted(_members(contract) - _present(model))
    if missing := missing or sorted(model.__abstractmethods__):
        parts = " and ".join(f"the {_what(contract, name)} {name}" for name in missing)
        return f"{model.__name__} lacks {parts} of a {PLUGIN_GROUPS[group].word}"
    wrong = (_misfit(model, contract, name) for name in sorted(_members(contract)))
    return next(filter(None, wrong), "")


def _contract(model: type[Plugin], group: str) -> type:
    """Return the contract that a model lacks least of, the one that asks for more if two serve."""
    present = _present(model)

    def distance(contract: type) -> tuple[int, int]:
        members = _members(contract)
        return len(members - present), -len(members)

    return min(PLUGIN_GROUPS[group].contracts, key=distance)


def _members(contract: type) -> frozenset[str]:
    return get_protocol_members(contract) - {"kind"}


def _present(model: type[Plugin]) -> frozenset[str]:
    return frozenset({*dir(model), *model.model_fields}) - model.__abstractmethods__


def _what(contract: type, name: str) -> str:
    return "method" if inspect.isfunction(getattr(contract, name, None)) else "attribute"


def _misfit(model: type[Plugin], contract: type, name: str) -> str:
    """Say why the method of that name cannot be called as the contract says; "": it can."""
    if _what(contract, name) == "attribute":
        return ""
    method = getattr(model, name)
    wanted = len(inspect.signature(getattr(contract, name)).parameters) - 1
    bound = not inspect.isfunction(inspect.getattr_static(model, name))  # a class or static method
    try:
        inspect.signature(method).bind(*range(wanted if bound else wanted + 1))
    except TypeError as error:
        return f"{model.__name__}.{name} must take {wanted} arguments: {error}"
    return ""
