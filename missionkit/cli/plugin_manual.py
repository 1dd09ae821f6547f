"""`missionkit plugins`: what there is, with parameters, units, defaults and manual page."""

from __future__ import annotations

import inspect
import json
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from missionkit.api.missions import assemble
from missionkit.chart.plugin_catalogue import Catalogue, source
from missionkit.chart.plugin_groups import PLUGIN_GROUPS
from missionkit.errors import UsageError, nearest
from missionkit.plugin import Plugin
from missionkit.sim.fault_injection import FAULT_KINDS as FAULTS
from missionkit.sim.fault_injection import FREE_FLYER_KINDS
from missionkit.sim.fault_injection import Kind as Fault
from missionkit.states.contract import StateKind


def plugins(name: str | None, files: Iterable[Path], *, as_json: bool) -> None:
    """List every plug-in, kind of state and fault, or show one plug-in or kind.

    Args:
        name: kind of plug-in or of state; all if `None`.
        files: with plug-ins, beside those installed.
        as_json: for programs; kinds of state are left out.

    Raises:
        UsageError: there is nothing called `name`.
    """
    catalogue = assemble(files)
    found = {
        kind: plugin for group in PLUGIN_GROUPS for kind, plugin in catalogue.group(group).items()
    }
    known = {*found} if as_json else {*found, *catalogue.kinds}
    broken = _broken(catalogue, name)
    if name is not None and name not in known and broken and not as_json:
        raise UsageError(f"plug-in {name!r} cannot be used: {broken[name]['broken']}")
    if name is not None and name not in {*known, *broken}:
        raise UsageError(f"unknown plug-in {name!r}; {nearest(name, known)}")
    if as_json:
        chosen = {kind: it for kind, it in found.items() if name in {None, kind}}
        described = {kind: _described(it) for kind, it in chosen.items()}
        _say(json.dumps(described | broken, indent=2))
    elif name is None:
        _say(overview(catalogue))
    else:
        pages = [page(found[name])] if name in found else []
        pages += [contract(catalogue.kinds[name])] if name in catalogue.kinds else []
        _say("\n\n".join(pages))


def _broken(catalogue: Catalogue, name: str | None) -> dict[str, dict[str, str]]:
    """Return why plug-ins of installed packages cannot be used: all, or the one of that name."""
    known = {kind for group in PLUGIN_GROUPS for kind in catalogue.group(group)}
    broken = {it: {"broken": why} for (_, it), why in catalogue.broken.items() if it not in known}
    return {it: why for it, why in broken.items() if name in {None, it}}


def overview(catalogue: Catalogue) -> str:
    """Return one line a plug-in, by group, a kind of state, and a fault."""
    lines = []
    for group in PLUGIN_GROUPS:
        lines.append(group)
        lines += [
            f"  {kind:20} {_summary(plugin)}"
            for kind, plugin in sorted(catalogue.group(group).items())
        ]
        lines.append("")
    if catalogue.broken:
        lines.append("broken, but harmless unless a mission uses them")
        lines += [f"  {name:20} {why}" for (_, name), why in sorted(catalogue.broken.items())]
        lines.append("")
    lines.append("kinds of state")
    lines += [f"  {kind.name:20} {kind.summary}" for kind in catalogue.kinds.values()]
    lines += ["", "faults of the simulator (missionkit run --fault)"]
    lines += [f"  {name:20} {_effect(fault)}" for name, fault in FAULTS.items()]
    lines += ["", "faults of a simulated free flyer"]
    lines += [f"  {name:20} {_effect(fault)}" for name, fault in FREE_FLYER_KINDS.items()]
    return "\n".join(lines)


def page(plugin: type[Plugin]) -> str:
    """Return the manual page of one plug-in."""
    lines = [f"{plugin.kind}  ({source(plugin)})", "", inspect.getdoc(plugin) or "", ""]
    rows = parameters(plugin)
    lines += [
        f"  {row['name']:16} {row['type']:10} {row['unit']:6} {row['default']:>10}  {row['about']}"
        for row in rows
    ]
    return "\n".join(line.rstrip() for line in lines).rstrip()


def contract(kind: StateKind) -> str:
    """Return the page of one kind of state: what it promises and demands."""
    rows = [
        ("control mode", str(kind.mode)),
        ("behaviour", kind.default_behavior or "required"),
        ("failsafes", "apply" if kind.flying else "do not apply"),
        ("must reach", ", ".join(kind.must_reach) or "nothing"),
    ]
    if (invariant := kind.invariant) is not None:
        late = f"broken for {invariant.tolerated:g} s -> {invariant.to_kind}"
        rows.append(("invariant", f"{invariant.says}; {late}"))
    for failsafe in kind.failsafes:
        given = "".join(f", {name} {value:g}" for name, value in failsafe.parameters.items())
        rows.append(("by default", f"{failsafe.use}{given} -> {failsafe.to_kind}"))
    lines = [f"{kind.name}  (kind of state)", "", kind.summary, ""]
    return "\n".join([*lines, *(f"  {name:16} {what}" for name, what in rows)])


def parameters(plugin: type[Plugin]) -> list[dict[str, str]]:
    """Return name, type, unit, default and description of each parameter."""
    schema = plugin.model_json_schema()
    required = schema.get("required", [])
    return [
        {
            "name": name,
            "type": _type(spec),
            "unit": _found(spec, "unit"),
            "default": "required" if name in required else json.dumps(spec.get("default")),
            "about": str(spec.get("description", "")),
        }
        for name, spec in schema.get("properties", {}).items()
    ]


def _described(plugin: type[Plugin]) -> dict[str, Any]:
    return {"about": inspect.getdoc(plugin), "parameters": parameters(plugin)}


def _summary(plugin: type[Plugin]) -> str:
    return (inspect.getdoc(plugin) or "").partition("\n")[0]


def _effect(fault: Fault) -> str:
    if fault.value is None:
        return fault.effect
    unit = "" if fault.unit == "1" else f" {fault.unit}"
    return f"{fault.effect} (default {fault.value:g}{unit})"


def _type(spec: dict[str, Any]) -> str:
    if "enum" in spec or "const" in spec:
        return "choice"
    for option in (spec, *spec.get("anyOf", ())):
        if option.get("type") not in {None, "null"}:
            return str(option["type"])
    return "value"


def _found(spec: dict[str, Any], key: str) -> str:
    """Return a mark of the schema, also from inside an alternative or an item."""
    if key in spec:
        return str(spec[key])
    inner = [*spec.get("anyOf", ()), *spec.get("prefixItems", ())]
    return next((found for it in inner if (found := _found(it, key))), "")


def _say(text: str) -> None:
    print(text)  # noqa: T201
