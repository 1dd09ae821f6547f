"""Where a real camera's images come from: the number of a device, a file, a URL."""

from __future__ import annotations

from pathlib import Path

from missionkit.errors import nearest

FILMS = {".avi", ".m4v", ".mjpeg", ".mjpg", ".mkv", ".mov", ".mp4", ".mpg", ".ts", ".webm"}
NOT_ONE_FILE = ("://", "!", "%")  # of a URL, a pipeline, numbered images: nothing that is one file


def found(source: int | str, folder: Path) -> int | str:
    """Return a source as OpenCV wants it: a file by its path, anything else as it is.

    Args:
        source: number of a device, file or URL; what lies in /dev is a device, there or not.
        folder: that a relative file is looked for in.

    Raises:
        ValueError: it names a file that does not exist; the nearest is named.
    """
    if isinstance(source, int) or is_device(source) or any(it in source for it in NOT_ONE_FILE):
        return source
    path = folder / source
    if path.is_file():
        return str(path)
    if path.exists():
        raise ValueError("this is not a file")
    raise ValueError(f"no such file in {path.parent}; {nearest(path.name, _films(path))}")


def is_device(source: int | str) -> bool:
    """Say whether a source is a camera of this computer."""
    return isinstance(source, int) or source.startswith("/dev/")


def is_film(source: int | str) -> bool:
    """Say whether a source is a file, whose images come as fast as they are read."""
    return isinstance(source, str) and Path(source).is_file()


def _films(missing: Path) -> list[str]:
    """Return the films, and the files of the same kind, that lie where one is missing."""
    if not missing.parent.is_dir():
        return []
    wanted = FILMS | {missing.suffix.lower()}
    return [it.name for it in missing.parent.iterdir() if it.suffix.lower() in wanted]
