"""What commands print: lines for people, JSON for programs."""

from __future__ import annotations

import json

from missionkit.errors import printable


def say(text: str) -> None:
    """Print a line."""
    print(printable(text))  # noqa: T201


def say_json(value: object) -> None:
    """Print a value as JSON."""
    print(json.dumps(value, indent=2))  # noqa: T201
