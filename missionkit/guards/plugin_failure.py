"""Plug-ins that misbehave."""

from __future__ import annotations

from typing import ClassVar

from typing_extensions import override

from missionkit.messages import Estimate, Verdict
from missionkit.messages.region import ONLY_TRUE, Quantity, Region
from missionkit.plugin import Guard

FAILING = Quantity("plug-in failing", most=1.0, whole=True)


class PluginFailed(Guard):
    """Holds while a plug-in raises, answers with NaN, or takes too long."""

    kind: ClassVar[str] = "plugin_failed"

    @override
    def check(self, seen: Estimate) -> Verdict:
        return Verdict(bool(seen.failing), "; ".join(seen.failing))

    @override
    def region(self) -> Region:
        return Region.of(FAILING, ONLY_TRUE)
