"""How wide text is, and text that fits into a width."""

from __future__ import annotations

from typing import Any, NamedTuple

from matplotlib.figure import Figure
from matplotlib.font_manager import FontProperties

MORE = " …"


class Font(NamedTuple):
    """A size (pt) and a weight."""

    size: float
    weight: str = "normal"

    @property
    def keywords(self) -> dict[str, Any]:
        """The keywords of a matplotlib text."""
        return {"fontsize": self.size, "fontweight": self.weight}


class Ruler:
    """Measures text in px as it will be drawn on a figure."""

    def __init__(self, figure: Figure) -> None:
        canvas: Any = figure.canvas
        self._renderer = canvas.get_renderer()
        self._fonts: dict[Font, FontProperties] = {}

    def width(self, text: str, font: Font) -> float:
        """Return how wide one line is (px)."""
        if font not in self._fonts:
            self._fonts[font] = FontProperties(size=font.size, weight=font.weight)
        wide = self._renderer.get_text_width_height_descent(text, self._fonts[font], ismath=False)[
            0
        ]
        return float(wide)

    def cut(self, text: str, font: Font, room: float) -> str:
        """Return a text that is at most `room` px wide; one that was cut ends in an ellipsis.

        Args:
            text: one line.
            font: it will be drawn in.
            room: px.
        """
        if self.width(text, font) <= room:
            return text
        short, long = 0, len(text)  # letters that fit, and that do not
        while long - short > 1:
            middle = (short + long) // 2
            fits = self.width(text[:middle].rstrip() + MORE, font) <= room
            short, long = (middle, long) if fits else (short, middle)
        return text[:short].rstrip() + MORE

    def lines(self, text: str, font: Font, room: float, most: int) -> list[str]:
        """Return a text in at most `most` lines, each at most `room` px wide, the last one cut.

        Args:
            text: broken at blanks.
            font: it will be drawn in.
            room: px.
            most: lines, at least 1.
        """
        lines = [""]
        for word in text.split():
            longer = f"{lines[-1]} {word}".lstrip()
            if lines[-1] and len(lines) < most and self.width(longer, font) > room:
                lines.append(word)
            else:
                lines[-1] = longer
        return [self.cut(line, font, room) for line in lines]
