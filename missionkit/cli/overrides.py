"""`--set NAME=VALUE`."""

from __future__ import annotations

from collections.abc import Iterable

from missionkit.errors import UsageError


def overrides(settings: Iterable[str]) -> dict[str, str]:
    """Read `--set NAME=VALUE` options.

    Raises:
        UsageError: one has no `=`.
    """
    pairs = [setting.partition("=") for setting in settings]
    for name, equals, value in pairs:
        if not (name and equals):
            raise UsageError(f"--set {name}{equals}{value}: expected NAME=VALUE, as in cruise=4")
    return {name: value for name, _, value in pairs}
