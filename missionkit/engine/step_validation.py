"""Checking what a behaviour answered, once, before anything is made of it."""

from __future__ import annotations

import math
from numbers import Real

import numpy as np

from missionkit.geometry import norm
from missionkit.messages import (
    Action,
    Device,
    DeviceOrder,
    GimbalAim,
    Goal,
    Guidance,
    HalfSpace,
    LandingTarget,
    Step,
    is_event,
)


def fault_of(answer: object) -> str:
    """Say what makes an answer unusable: a wrong type, shape or number; empty if nothing does."""
    if not isinstance(answer, Step):
        return f"{type(answer).__name__}, expected a Step"
    action: object = answer.action
    parts = {
        "action": action is None or isinstance(action, Action),
        "guidance": _guides(answer.guidance),
        "goal": _leads(answer.goal),
        "height": _number(answer.height),
        "payload": _text_or_none(answer.payload),
        "note": isinstance(answer.note, str),
        "events": _events(answer.events),
        "stop": isinstance(answer.stop, bool),
        "retreat": answer.retreat is None or _vector(answer.retreat),
        "bound": _bounds(answer.bound),
        "takes_over": isinstance(answer.takes_over, bool),
        "lands": isinstance(answer.lands, bool),
        "orders": _orders(answer.orders),
        "chosen": _text_or_none(answer.chosen),
        "gimbal": _aims(answer.gimbal),
        "landing_target": _pad(answer.landing_target),
    }
    wrong = [name for name, sound in parts.items() if not sound]
    return f"a Step with {wrong[0]} of a wrong type or not finite" if wrong else ""


def push_fault(answer: object) -> str:
    """Say what makes a planner's answer unusable; empty if nothing does."""
    if not (isinstance(answer, tuple) and len(answer) == 2):
        return f"{type(answer).__name__}, expected a velocity and its memory"
    return "" if _vector(answer[0]) else "a velocity of a wrong type or not finite"


def _guides(guidance: object) -> bool:
    if not isinstance(guidance, Guidance):
        return guidance is None
    speed: object = guidance.speed
    return (
        _vector(guidance.position)
        and speed is not None
        and _number(speed)
        and (guidance.velocity is None or _vector(guidance.velocity))
        and (guidance.work is None or _vector(guidance.work))
        and _number(guidance.yaw)
        and _number(guidance.final_yaw)
        and _turned(guidance.attitude)
    )


def _leads(goal: object) -> bool:
    if not isinstance(goal, Goal):
        return goal is None
    return _vector(goal.position) and _number(goal.yaw)


def _bounds(bound: object) -> bool:
    if not isinstance(bound, HalfSpace):
        return bound is None
    return _vector(bound.point) and _vector(bound.normal) and abs(norm(bound.normal) - 1.0) < 1e-6


def _orders(orders: object) -> bool:
    return isinstance(orders, tuple) and all(
        isinstance(it, DeviceOrder)
        and isinstance(it.device, Device)
        and type(it.number) is int
        and it.value is not None
        and _number(it.value)
        for it in orders
    )


def _aims(aim: object) -> bool:
    if not isinstance(aim, GimbalAim):
        return aim is None
    return (
        (aim.place is None or _vector(aim.place))
        and _text_or_none(aim.target)
        and (aim.angles is None or all(it is not None and _number(it) for it in aim.angles))
    )


def _pad(target: object) -> bool:
    if not isinstance(target, LandingTarget):
        return target is None
    return isinstance(target.name, str) and _vector(target.offset)


def _events(events: object) -> bool:
    return isinstance(events, tuple) and all(map(is_event, events))


def _text_or_none(text: object) -> bool:
    return text is None or isinstance(text, str)


def _number(number: object) -> bool:
    return number is None or (isinstance(number, Real) and math.isfinite(number))


def _turned(attitude: object) -> bool:
    if attitude is None:
        return True
    if not (isinstance(attitude, np.ndarray) and attitude.shape == (4,)):
        return False
    return abs(math.hypot(*attitude.tolist()) - 1.0) < 1e-6


def _vector(vector: object) -> bool:
    return (
        isinstance(vector, np.ndarray)
        and vector.shape == (3,)
        and vector.dtype.kind in "fiu"
        and math.isfinite(vector[0] + vector[1] + vector[2])
    )
