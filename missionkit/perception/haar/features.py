"""Haar-like features of a square window: contrasts between rectangles.

A feature is Σ w_r S_r / (n σ): sums S_r of up to three rectangles with weights that make a
constant window 0, over the window's n pixels and its standard deviation σ, so that brightness and
contrast do not matter.

Source: P. Viola, M. Jones, "Rapid Object Detection using a Boosted Cascade of Simple Features",
2001; R. Lienhart, J. Maydt, "An Extended Set of Haar-like Features", 2002: its upright features. A
robot is seen at any heading, so the set turned by 45 deg adds nothing new.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Final, NamedTuple

import numpy as np
import numpy.typing as npt

SIDE: Final = 24  # px, of the window
RECTANGLES: Final = 3  # at most in a feature

Ints = npt.NDArray[np.int32]
Floats = npt.NDArray[np.float64]
Patches = npt.NDArray[np.uint8]  # (n, SIDE, SIDE)


class Features(NamedTuple):
    """Features of a window."""

    rectangles: Ints  # (n, RECTANGLES, 4): left, top, width, height, px; unused ones are empty
    weights: Floats  # (n, RECTANGLES)

    def only(self, which: npt.NDArray[np.intp]) -> Features:
        """Return some of them."""
        return Features(self.rectangles[which], self.weights[which])


def pool(step: int = 2, least: int = 4) -> Features:
    """Return features of all kinds, at places and of sizes on a grid.

    Args:
        step: px, between places and between sizes.
        least: px, width or height of the smallest part.
    """
    rows = list(_all(step, least))
    rectangles = np.zeros((len(rows), RECTANGLES, 4), np.int32)
    weights = np.zeros((len(rows), RECTANGLES))
    for i, parts in enumerate(rows):
        for j, (rectangle, weight) in enumerate(parts):
            rectangles[i, j], weights[i, j] = rectangle, weight
    return Features(rectangles, weights)


_Part = tuple[tuple[int, int, int, int], float]
_SHAPES: Final = (  # cells across and down, and which of them stand out
    (2, 1, (0, 0, 1, 1)),  # edges
    (1, 2, (0, 0, 1, 1)),
    (3, 1, (1, 0, 1, 1)),  # lines
    (1, 3, (0, 1, 1, 1)),
    (4, 1, (1, 0, 2, 1)),
    (1, 4, (0, 1, 1, 2)),
    (3, 3, (1, 1, 1, 1)),  # a centre in its surround
    (4, 4, (1, 1, 2, 2)),
)


def _all(step: int, least: int) -> Iterator[tuple[_Part, ...]]:
    for across, down, (i, j, wide, tall) in _SHAPES:
        for w, h, x, y in _places(across, down, step, least):
            outer = (x, y, across * w, down * h)
            inner = (x + i * w, y + j * h, wide * w, tall * h)
            yield (outer, -1.0), (inner, across * down / (wide * tall))
    for w, h, x, y in _places(2, 2, step, least):  # two squares of a chequerboard
        outer = (x, y, 2 * w, 2 * h)
        yield (outer, -1.0), ((x, y, w, h), 2.0), ((x + w, y + h, w, h), 2.0)


def _places(across: int, down: int, step: int, least: int) -> Iterator[tuple[int, int, int, int]]:
    """Yield size and place of the cells of shapes that fit into the window, px."""
    for w in range(max(1, least // across), SIDE // across + 1, max(1, step // across)):
        for h in range(max(1, least // down), SIDE // down + 1, max(1, step // down)):
            for x in range(0, SIDE - across * w + 1, step):
                for y in range(0, SIDE - down * h + 1, step):
                    yield w, h, x, y
