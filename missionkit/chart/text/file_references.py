"""Files that a mission names: beside it or in folders below, wherever links lead."""

from __future__ import annotations

from pathlib import Path

from missionkit.chart.text.regular_file import irregular

NO_SUCH_FILE = "no such file beside the mission"


def unfit(root: Path, path: Path) -> str:
    """Say why a file cannot be read for a mission; "": it can.

    Args:
        root: folder of the mission; nothing outside it is read.
        path: of the file.
    """
    try:
        inside = path.resolve().is_relative_to(root.resolve())
        there, other = path.is_file(), irregular(path)
    except (OSError, RuntimeError, ValueError):  # links in a circle, or no name of a file
        return "not the name of a file that can be read"
    if not inside:
        return "outside the folder of the mission"
    return "" if there else f"it is {other}, not a file" if other else NO_SUCH_FILE
