"""Whatever is sent, the autopilot stays alive and its vehicle in the real world."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from pymavlink.dialects.v20 import ardupilotmega as mavlink

from missionkit.sitl.command_protocol import HANDLERS
from missionkit.sitl.mavlink_autopilot import SERVICES

REALS = (0.0, 1.0, -1.0, 0.5, 1e9, -1e9, math.nan, math.inf, -math.inf)
KINDS = (
    *SERVICES,
    *("COMMAND_LONG", "COMMAND_INT", "MISSION_COUNT", "MISSION_ITEM_INT", "MISSION_ITEM"),
    *("MISSION_REQUEST_LIST", "MISSION_REQUEST_INT", "MISSION_SET_CURRENT", "MISSION_CLEAR_ALL"),
)
BITS = {"uint8_t": 8, "uint16_t": 16, "uint32_t": 32, "uint64_t": 64}
SIGNED = {"int8_t": 8, "int16_t": 16, "int32_t": 32, "int64_t": 64}


def value(kind: str, count: int, rng: np.random.Generator) -> Any:
    if kind == "char":
        return rng.bytes(count)
    if count > 1:
        return [value(kind, 1, rng) for _ in range(count)]
    if kind in BITS:
        return int(rng.choice([0, 1, 3, 8, 2 ** BITS[kind] - 1]) if BITS[kind] < 64 else 0)
    if kind in SIGNED:
        most = 2 ** (SIGNED[kind] - 1) - 1
        return int(rng.choice([0, 1, -1, most, -most - 1])) if SIGNED[kind] < 64 else 0
    return float(rng.choice(REALS))


def nonsense(name: str, rng: np.random.Generator) -> Any:
    """Return a message with arbitrary fields that is still for this autopilot."""
    (cls,) = [it for it in mavlink.mavlink_map.values() if it.msgname == name]
    counts = dict(zip(cls.ordered_fieldnames, cls.array_lengths, strict=True))
    kinds = dict(zip(cls.fieldnames, cls.fieldtypes, strict=True))
    fields = {it: value(kinds[it], counts[it] or 1, rng) for it in cls.fieldnames}
    fields |= {it: 1 for it in ("target_system", "target_component") if it in fields}
    if name.startswith("COMMAND_"):
        fields["command"] = int(rng.choice(list(HANDLERS)))
    return cls(**fields)


@pytest.mark.parametrize("seed", range(2))
def test_nonsense_is_survived(either: Any, seed: int) -> None:
    rng = np.random.default_rng(seed)
    either.take_off()
    for _ in range(250):
        either.send(nonsense(str(rng.choice(KINDS)), rng))
        either.run(0.02)
        assert np.isfinite(either.truth.position).all()
        assert np.isfinite(either.truth.velocity).all()
    either.seen.clear()
    either.run(3.0)
    assert either.all("HEARTBEAT")


def test_noise_on_the_wire_is_skipped(either: Any) -> None:
    rng = np.random.default_rng(0)
    for _ in range(50):
        either.channel.take(rng.bytes(40), either.state.now)
        either.run(0.02)
    either.channel.take(bytes(300), either.state.now)
    assert either.command(512, 148) == 0
