"""The person who pilots by the page."""

from __future__ import annotations

from typing import ClassVar

from typing_extensions import override

from missionkit.guards.comparison import ComparedGuard, Comparison
from missionkit.messages import Estimate
from missionkit.messages.region import Quantity
from missionkit.units import Seconds

OPERATOR_SILENCE = Quantity("operator silence", unit="s")


class OperatorSilent(ComparedGuard):
    """Holds once the pilot's page has given no sign of life for `longer_than`.

    Unknown without a page (`missionkit run --page`), and until a pilot has opened it.
    """

    kind: ClassVar[str] = "operator_silent"
    longer_than: Seconds = 10.0

    @override
    def measured(self, seen: Estimate) -> float | str:
        if seen.operator_silence is None:
            return "no pilot has opened the page"
        return seen.operator_silence

    @override
    def comparison(self) -> Comparison:
        return Comparison(OPERATOR_SILENCE, "above", self.longer_than)
