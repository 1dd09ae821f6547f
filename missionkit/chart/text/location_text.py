"""Where in the mission something stands, in words."""

from __future__ import annotations

from collections.abc import Iterator

Path = tuple[int | str, ...]
_ONE_OF = {
    "states": "state",
    "targets": "target",
    "guards": "guard",
    "params": "parameter",
    "transitions": "transition",
    "failsafes": "failsafe",
    "perception": "detector",
    "do": "action",
    "entry": "entry action",
    "exit": "exit action",
    "obstacles": "obstacle",
    "markers": "marker",
}


def location_text(data: object, path: Path) -> str:
    """Return "state 'gps', transition 2, when" for a path to something in there.

    The key that ends the path is left out: the message itself names it.
    """
    ends = [at for at, step in enumerate(path) if isinstance(step, str)]
    last = ends[-1] if ends else 0
    return ", ".join(_words(data, path, last))


def _words(data: object, path: Path, last: int) -> Iterator[str]:
    at = 0
    while at < last:
        step = path[at]
        following = path[at + 1] if at + 1 < len(path) else None
        data = _child(data, step)
        if step in _ONE_OF and isinstance(data, (dict, list)) and following is not None:
            yield f"{_ONE_OF[str(step)]} {_name(data, following)}"
            data = _child(data, following)
            at += 2
        else:
            yield f"item {step + 1}" if isinstance(step, int) else step
            at += 1


def _name(container: object, step: int | str) -> str:
    if isinstance(step, str):
        return repr(step)
    item = _child(container, step)
    named = item.get("name") if isinstance(item, dict) else None
    return repr(str(named)) if isinstance(named, str) else str(step + 1)


def _child(data: object, step: int | str) -> object:
    if isinstance(data, dict):
        return data.get(step)
    if isinstance(data, list) and isinstance(step, int) and step < len(data):
        return data[step]
    return None
