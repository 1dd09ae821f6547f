"""Plug-ins that misbehave."""

from __future__ import annotations

from typing import ClassVar

from typing_extensions import override

from missionkit.guards.comparison import FlagGuard
from missionkit.messages import Estimate
from missionkit.messages.region import Quantity

FAILING = Quantity("plug-in failing", most=1.0, whole=True)


class PluginFailed(FlagGuard):
    """Holds while a plug-in raises, answers with NaN, or takes too long."""

    kind: ClassVar[str] = "plugin_failed"

    @override
    def quantity(self) -> Quantity:
        return FAILING

    @override
    def raised(self, seen: Estimate) -> bool:
        return bool(seen.failing)

    @override
    def reason(self, seen: Estimate) -> str:
        return "; ".join(seen.failing)
