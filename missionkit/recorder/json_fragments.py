"""JSON text of the small things that every message is made of.

Written by hand instead of through `json.dumps`: it runs several times a tick. Numbers keep every
digit, so that equal text means equal numbers.
"""

from __future__ import annotations

import math
from collections.abc import Iterable
from json.encoder import encode_basestring_ascii as text

from missionkit.geometry import Quat, Transform, Vec3
from missionkit.messages import Verdict

__all__ = [
    "colour",
    "flag",
    "nanoseconds",
    "pose",
    "quaternion",
    "stamp",
    "text",
    "texts",
    "transform",
    "vector",
    "verdict",
    "verdicts",
]


def nanoseconds(time: float) -> int:
    """Return mission time (s) in whole nanoseconds."""
    return round(time * 1e9)


def stamp(time: float) -> str:
    """Return mission time (s) as Foxglove's `time`."""
    sec, nsec = divmod(nanoseconds(time), 1_000_000_000)
    return f'{{"sec":{sec},"nsec":{nsec}}}'


def flag(value: bool) -> str:  # noqa: FBT001
    """Return a boolean."""
    return "true" if value else "false"


def texts(values: Iterable[str]) -> str:
    """Return a list of strings."""
    return f"[{','.join(map(text, values))}]"


def vector(v: Vec3) -> str:
    """Return (3,) as x, y, z."""
    x, y, z = v.tolist()
    return f'{{"x":{x},"y":{y},"z":{z}}}'


def quaternion(q: Quat) -> str:
    """Return (4,) w, x, y, z with its parts named."""
    w, x, y, z = q.tolist()
    return f'{{"x":{x},"y":{y},"z":{z},"w":{w}}}'


def colour(r: float, g: float, b: float, a: float = 1.0) -> str:
    """Return a colour, each part from 0 to 1.

    Args:
        r: red.
        g: green.
        b: blue.
        a: opacity.
    """
    return f'{{"r":{r},"g":{g},"b":{b},"a":{a}}}'


def pose(position: Vec3, attitude: Quat) -> str:
    """Return a pose from (3,) m and (4,)."""
    return f'{{"position":{vector(position)},"orientation":{quaternion(attitude)}}}'


def transform(at: str, parent: str, child: str, link: Transform) -> str:
    """Return one link of the frame tree; `link` maps child coordinates to the parent's.

    Args:
        at: JSON of the time.
        parent: name of the frame.
        child: name of the frame.
        link: child to parent, m.
    """
    return (
        f'{{"timestamp":{at},"parent_frame_id":"{parent}","child_frame_id":"{child}",'
        f'"translation":{vector(link.translation)},"rotation":{quaternion(link.rotation)}}}'
    )


def _number(key: str, value: float | None) -> str:
    if value is None or not math.isfinite(value):
        return ""
    return f',"{key}":{float(value)}'


def verdict(name: str, given: Verdict) -> str:
    """Return one guard's answer; what it does not know is left out."""
    holds = "unknown" if given.holds is None else "yes" if given.holds else "no"
    why = f',"why":{text(given.why)}' if given.why else ""
    return (
        f'{{"name":{text(name)},"holds":"{holds}"{_number("value", given.value)}'
        f"{_number('threshold', given.threshold)}{_number('margin', given.margin)}{why}}}"
    )


def verdicts(answers: Iterable[tuple[str, Verdict]]) -> str:
    """Return a list of guards' answers."""
    return f"[{','.join([verdict(name, given) for name, given in answers])}]"
