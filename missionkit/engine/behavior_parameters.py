"""Behaviours whose parameters variables give, with the values at the entry of their state."""

from __future__ import annotations

from typing import Any, NamedTuple

from missionkit.chart.model.variables import Value, Values
from missionkit.chart.semantics.compiled_chart import CompiledState
from missionkit.plugin_containment import Containment
from missionkit.plugin_protocols import BehaviorProtocol


class ParameterizedMemory(NamedTuple):
    """Memory of a behaviour, and the values that it began with."""

    values: tuple[Value, ...]
    memory: Any


class Behaving(NamedTuple):
    """A behaviour as it flies now, and its memory."""

    behavior: BehaviorProtocol
    memory: Any
    values: tuple[Value, ...] | None = None  # None: no variable gives it a parameter

    def remembered(self, memory: Any) -> Any:
        """Return what is to be kept of a memory."""
        return memory if self.values is None else ParameterizedMemory(self.values, memory)


def behaving(
    state: CompiledState, kept: Any, variables: Values, contain: Containment
) -> Behaving | None:
    """Return the behaviour of a state; None: it cannot be made, which `contain` keeps.

    Args:
        state: with a behaviour.
        kept: what was kept of it; anything else: its state was entered at this tick.
        variables: values now.
        contain: keeps what went wrong.
    """
    behavior, made = state.behavior, state.with_values
    if behavior is None:
        return None
    if made is None:
        return Behaving(behavior, kept)
    begun = isinstance(kept, ParameterizedMemory)
    values = kept.values if begun else tuple(variables[name] for name in state.given_by)
    boxed = contain.call(behavior.kind, made, values, foreign=True)
    if boxed is None:
        return None
    return Behaving(boxed[0], kept.memory if begun else None, values)
