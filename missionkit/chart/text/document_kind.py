"""Telling missions, worlds and maps apart by keys that the others do not have."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

_KEYS: Mapping[str, frozenset[str]] = MappingProxyType(
    {
        "mission": frozenset({"missionkit", "mission", "initial", "states"}),
        "world": frozenset({"world"}),  # missions have it too, and come first
        "map": frozenset({"image", "resolution"}),
    }
)


def document_kind(data: object) -> str:
    """Return "mission", "world" or "map" by the keys of a document; "" if it could be any.

    >>> document_kind({"world": "orchard", "markers": []})
    'world'
    >>> document_kind({"missionkit": 1, "world": "worlds/orchard.yaml"})
    'mission'
    >>> document_kind({"param": {}})
    ''
    """
    if not isinstance(data, dict):
        return ""
    return next((kind for kind, keys in _KEYS.items() if keys & data.keys()), "")
