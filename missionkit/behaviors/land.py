"""Landing."""

from __future__ import annotations

from typing import Any, ClassVar

from typing_extensions import override

from missionkit.messages import Action, Estimate, Step
from missionkit.plugin import Behavior


class Land(Behavior):
    """Let the autopilot land here; done when it stands on the ground, disarmed."""

    kind: ClassVar[str] = "land"

    @override
    def step(self, seen: Estimate, memory: Any) -> Step:
        status = seen.status
        if status is not None and not status.in_air and not status.armed:
            return Step(done=True)
        return Step(action=Action.LAND)
