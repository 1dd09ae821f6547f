"""Numbers and tables as the report writes them."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence

from missionkit.campaigns.statistics import ConfidenceInterval

UNITS = {
    "duration": ("mission time", "s", 1.0, 1),
    "clearance": ("least clearance", "m", 1.0, 2),
    "distance": ("distance flown", "m", 1.0, 1),
    "armed": ("time armed", "s", 1.0, 1),
    "energy": ("energy", "kJ", 1e-3, 2),
    "position_error": ("distance from the goal on arrival", "cm", 100.0, 1),
    "yaw_error": ("heading error on arrival", "deg", 180.0 / math.pi, 2),
    "worst_error": ("farthest from the goal", "cm", 100.0, 1),
    "worst_sideways": ("farthest sideways", "cm", 100.0, 1),
    "robots_home": ("robots home", "", 1.0, 1),
    "robots_lost": ("robots lost", "", 1.0, 1),
}


def title_of(name: str) -> str:
    """Return a metric's name and unit."""
    title, unit, _, _ = UNITS.get(name, (name, "", 1.0, 3))
    return f"{title} ({unit})" if unit else title


def scaled(name: str, values: Iterable[float]) -> list[float]:
    """Return values of a metric in the unit that is shown."""
    factor = UNITS[name][2] if name in UNITS else 1.0
    return [factor * value for value in values]


def number(value: float, name: str, *, sign: bool = False) -> str:
    """Return a metric's value in its unit.

    Args:
        value: in SI units; "—" if it is not finite.
        name: of the metric, which determines unit and digits; 3 digits and no unit if it has none.
        sign: write a plus too, for differences.
    """
    _, _, factor, digits = UNITS.get(name, ("", "", 1.0, 3))
    if not math.isfinite(value):
        return "—"
    shown = round(factor * value, digits) + 0.0  # no "-0.0"
    return f"{shown:+.{digits}f}" if sign else f"{shown:.{digits}f}"


def percent(rate: float, *, sign: bool = False) -> str:
    """Return a rate.

    >>> percent(0.9642), percent(1.0), percent(0.9996), percent(0.02, sign=True)
    ('96.4 %', '100 %', '99.96 %', '+2.0 %')
    """
    if not math.isfinite(rate):
        return "—"
    value = 100.0 * rate
    close = 0.0 < abs(value) < 0.1 or 99.9 < value < 100.0
    digits = 0 if value in {0.0, 100.0} else 2 if close else 1
    return f"{value:+.{digits}f} %" if sign else f"{value:.{digits}f} %"


def plural(count: int, what: str) -> str:
    """Return how many there are.

    >>> plural(1, "time"), plural(3, "time")
    ('1 time', '3 times')
    """
    return f"{count} {what}{'' if count == 1 else 's'}"


def between(interval: ConfidenceInterval, shown: Callable[[float], str]) -> str:
    """Return an interval's bounds in words."""
    return f"between {shown(interval.low)} and {shown(interval.high)}"


def table(heads: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    """Return an HTML table; a heading that begins with + is of a column of numbers."""
    styles = [' class="n"' if head.startswith("+") else "" for head in heads]
    cells = (f"<th{s}>{h.lstrip('+')}</th>" for h, s in zip(heads, styles, strict=True))
    top = f"<tr>{''.join(cells)}</tr>" if heads else ""
    return f"<table>{top}{''.join(_line(row, styles) for row in rows)}</table>"


def _line(row: Sequence[str], styles: Sequence[str]) -> str:
    styles = [*styles, *[""] * (len(row) - len(styles))]
    return f"<tr>{''.join(f'<td{s}>{c}</td>' for c, s in zip(row, styles, strict=True))}</tr>"


def figure(drawn: str, caption: str) -> str:
    """Return a figure with its caption."""
    return f"<figure>{drawn}<figcaption>{caption}</figcaption></figure>"
