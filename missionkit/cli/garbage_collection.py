"""When Python looks for cyclic garbage: rarely in commands that read, answer and end.

Reading and checking a mission makes some 150,000 objects, nearly all of which stay. Python would
look through them many times on the way, and once more at the end: a fifth of the processor time.
"""

from __future__ import annotations

import atexit
import gc
from collections.abc import Iterator
from contextlib import contextmanager

OBJECTS = 300_000  # new ones between two collections


@contextmanager
def collected_rarely() -> Iterator[None]:
    """Collect garbage rarely while a short command runs, and not at all when Python exits."""
    before = gc.get_threshold()
    gc.set_threshold(OBJECTS, *before[1:])
    atexit.register(gc.freeze)  # nothing of a program that ends needs to be looked through
    try:
        yield
    finally:
        gc.set_threshold(*before)
