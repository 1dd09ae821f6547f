"""Options of `missionkit run --resume`: those of the run, and what may change in between."""

from __future__ import annotations

from pathlib import Path

from missionkit.api.run_origin import Origin, plugin_changes, plugins_named
from missionkit.cli.run_options import RunOptions
from missionkit.errors import UsageError


def recalled(order: RunOptions, origin: Origin) -> RunOptions:
    """Return an order for the rest of a run: what it does not say is as it was.

    Raises:
        UsageError: an option that a run in progress cannot change.
    """
    if order.faults:
        raise UsageError("--fault cannot be changed by --resume")
    return order._replace(
        mission=Path(origin.mission) if order.mission == Path() else order.mission,
        settings=order.settings or origin.settings,
        seed=origin.seed,
        faults=origin.faults,
    )


def check_plugins(order: RunOptions, before: Origin) -> None:
    """Refuse plug-in files that the user did not name, or that were changed, before any is run.

    A folder may come from anywhere: what it says is read, never run. Only `--plugin` on the
    command line makes a file run (docs/decisions/0019-recording.md).

    Raises:
        UsageError: one is missing on the command line, or is not the one that was flown.
    """
    if before.plugins and not order.plugins:
        raise UsageError(
            f"{order.resume}: this run used plug-in files, which --resume does not run by itself; "
            f"review them and name them yourself: {plugins_named(before)}"
        )
    lines = plugin_changes(before, order.plugins)
    if lines and not order.force:
        raise UsageError(
            "\n".join([f"{order.resume}: a plug-in differs from the one flown", *lines])
        )
