"""Events for the mission and sentences for the record, from any thread of a vehicle."""

from __future__ import annotations

import threading


class EventNotes:
    """Events and sentences kept until they are taken; any thread may add some."""

    def __init__(self) -> None:
        self._events: list[str] = []
        self._remarks: list[str] = []
        self._lock = threading.Lock()

    def note(self, event: str) -> None:
        """Keep an event for the next observation."""
        with self._lock:
            self._events.append(event)

    def remark(self, sentence: str) -> None:
        """Keep a sentence for the record."""
        with self._lock:
            self._remarks.append(sentence)

    def take_events(self) -> tuple[str, ...]:
        """Return the events since the last call."""
        with self._lock:
            events, self._events = tuple(self._events), []
        return events

    def take_remarks(self) -> tuple[str, ...]:
        """Return what is to be recorded since the last call, a sentence each."""
        with self._lock:
            remarks, self._remarks = tuple(self._remarks), []
        return remarks
