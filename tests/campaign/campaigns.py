"""Short campaigns for tests, and rows of flights that never took place."""

from __future__ import annotations

from pathlib import Path

from samples import HOP

from missionkit.campaigns.run_row import Case, Row

BOMBED = HOP.replace("2.0}", '2.0, how: "no"}').replace(
    "when: done", "when: {all: [done, {use: bomb, how: $how}]}"
)

BOMB = '''\
"""A guard that breaks the process that asks it."""

import os
import signal
from typing import ClassVar

from missionkit.plugin import Guard
from missionkit.messages import Verdict


class Bomb(Guard):
    """Holds, unless its parameters make it do harm."""

    kind: ClassVar[str] = "bomb"
    how: str = "no"

    def check(self, seen):
        if seen.now > 1.0 and self.how == "die":
            os._exit(7)
        if seen.now > 1.0 and self.how == "hang":
            signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGALRM})
            while True:
                pass
        return Verdict.at_least(1.0, 0.0)
'''


def hop(folder: Path) -> str:
    """Write the mission; return its path."""
    path = folder / "hop.yaml"
    path.write_text(HOP)
    return str(path)


def bombed(folder: Path) -> tuple[str, str]:
    """Write the mission that can be blown up and its plug-in; return both paths."""
    mission, plugin = folder / "bombed.yaml", folder / "bomb.py"
    mission.write_text(BOMBED)
    plugin.write_text(BOMB)
    return str(mission), str(plugin)


def cases(count: int, **settings: str) -> list[Case]:
    return [Case(n, 0, n, settings) for n in range(count)]


def row(number: int = 0, outcome: str = "success", **given: object) -> Row:
    """A row as a flight would have left it."""
    whole = {
        "number": number,
        "variant": 0,
        "seed": number,
        "settings": {},
        "outcome": outcome,
        "reason": "flown as planned" if outcome == "success" else "hit an obstacle or the ground",
        "parameters": {"height": 2.0},
        "metrics": {"duration": 9.0 + number % 7, "clearance": None},
        "times": {"idle": 4.0, "land": 5.0},
        "transitions": {"idle -> land": 1},
        "visits": (("idle", 4.0), ("land", 5.0)),
    }
    return Row.model_validate({**whole, **given})
