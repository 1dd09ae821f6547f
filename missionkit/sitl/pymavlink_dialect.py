"""The names of pymavlink that this package uses, imported in one place."""

from __future__ import annotations

from typing import Any, TypeAlias

from pymavlink.dialects.v20 import ardupilotmega as mavlink

Message: TypeAlias = Any  # a message of pymavlink, which has no types
__all__ = ["Message", "mavlink"]
