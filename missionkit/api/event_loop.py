"""Calling what runs an event loop of its own from where one runs already, such as a notebook."""

from __future__ import annotations

import asyncio
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import TypeVar

T = TypeVar("T")


def outside_loop(call: Callable[[], T]) -> T:
    """Return what a call gives; made on a thread of its own if an event loop runs on this one.

    Args:
        call: runs an event loop until it is done.
    """
    try:
        asyncio.get_running_loop()
    except RuntimeError:
        return call()
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(call).result()
