"""Guidance from behaviours, and commands to the vehicle."""

from __future__ import annotations

from enum import StrEnum
from typing import Any, NamedTuple

from missionkit.geometry import Quat, Vec3
from missionkit.messages.estimate import Goal
from missionkit.messages.gimbal import GimbalAim, GimbalAngles


class Action(StrEnum):
    """A discrete request to the autopilot."""

    ARM = "arm"
    TAKE_OFF = "take_off"
    HOLD = "hold"
    LAND = "land"
    PRECISION_LAND = "precision_land"  # the autopilot lands on `landing_target`, by its own rules
    RETURN = "return"  # the autopilot flies home and lands, by its own rules
    DISARM = "disarm"


class LandingTarget(NamedTuple):
    """The pad of a precision landing, sent to the autopilot at every tick."""

    name: str  # of the target
    offset: Vec3  # (3,), m, NED, from the vehicle


class Setpoint(NamedTuple):
    """A velocity to fly until the next command."""

    velocity: Vec3  # (3,), m/s, NED
    yaw_rate: float  # rad/s, clockwise seen from above


class PositionSetpoint(NamedTuple):
    """A place to be at until the next command; the autopilot flies there by its own rules."""

    position: Vec3  # (3,), m, NED, from the take-off point
    yaw: float  # rad


class AttitudeSetpoint(NamedTuple):
    """An attitude to hold until the next command."""

    attitude: Quat  # (4,), body to world
    thrust: float  # 0 to 1, upwards along the body


class Wrench(NamedTuple):
    """A force and a torque to exert until the next command, for a vehicle that flies by thrusters.

    In the body's axes, at its centre of mass. The vehicle exerts what its thrusters can.
    """

    force: Vec3  # (3,), N, body
    torque: Vec3  # (3,), N·m, body


class Device(StrEnum):
    """What a device order is for."""

    CAMERA = "camera"  # take a photo; value: its number in the flight
    SERVO = "servo"  # value: µs
    RELAY = "relay"  # value: 1 on, 0 off
    GRIPPER = "gripper"  # value: 1 grab, 0 release


class DeviceOrder(NamedTuple):
    """Something that a payload is to do once."""

    device: Device
    number: int  # which of its kind, from 1
    value: float


AutopilotSetpoint = Setpoint | PositionSetpoint | AttitudeSetpoint
AnySetpoint = AutopilotSetpoint | Wrench


class Command(NamedTuple):
    """Command to the vehicle for one tick; without setpoint and action, the autopilot holds."""

    setpoint: AnySetpoint | None = None
    action: Action | None = None
    height: float | None = None  # m, with TAKE_OFF
    payload: str | None = None  # name of the actuator to be on during this tick
    own_velocity: Vec3 | None = None  # (3,), m/s, NED, estimated while a target is seen
    orders: tuple[DeviceOrder, ...] = ()  # each carried out once
    gimbal: GimbalAngles | None = None  # to turn it to; None: it stays as it is
    landing_target: LandingTarget | None = None  # with PRECISION_LAND; None: out of sight


class Mode(StrEnum):
    """P1's control modes, each with its gains."""

    NONE = "none"  # the autopilot flies by itself: on the ground, taking off, landing
    GPS = "gps"
    VISUAL = "visual"
    TRAJECTORY = "trajectory"


class Guidance(NamedTuple):
    """Goal and speed of a behaviour; control turns them into a setpoint."""

    position: Vec3  # (3,), m, NED, desired
    speed: float  # m/s, not to be exceeded
    velocity: Vec3 | None = None  # (3,), m/s, NED, reference velocity to feed forward
    yaw: float | None = None  # rad; None: P1's hybrid yaw law chooses
    avoid: bool = True  # let the potential field push away from obstacles
    work: Vec3 | None = None  # (3,), m, NED, of the object of the task, which may be approached
    final_yaw: float | None = None  # rad, ψ_target of the yaw law: wanted at the goal
    attitude: Quat | None = None  # (4,), body to world, for vehicles that turn about any axis


class HalfSpace(NamedTuple):
    """The side of a plane where the vehicle must stay."""

    point: Vec3  # (3,), m, NED, on the plane
    normal: Vec3  # (3,), unit, from the plane to that side


class Step(NamedTuple):
    """Answer of a behaviour at one tick."""

    guidance: Guidance | None = None  # None and no action: hold still
    action: Action | None = None
    height: float | None = None  # m, with TAKE_OFF
    payload: str | None = None
    done: bool = False
    goal: Goal | None = None
    note: str = ""  # shown in the live view and the record
    memory: Any = None  # passed to the behaviour at the next tick
    events: tuple[str, ...] = ()  # for the chart, handled at the next tick
    stop: bool = False  # come to rest by a velocity of zero, whatever the mode; no guidance
    retreat: Vec3 | None = None  # (3,), m/s, NED, flown instead of zero while it stops
    bound: HalfSpace | None = None  # never to be left, even while it holds still
    takes_over: bool = False  # fly the guidance although the state leaves flying to the autopilot
    lands: bool = False  # leads to the ground on purpose: no height is kept above it
    orders: tuple[DeviceOrder, ...] = ()  # for devices of the payload, each once
    chosen: str | None = None  # the tracked target that `tracked` stands for from now on
    gimbal: GimbalAim | None = None  # its aim from now on, in later states too
    landing_target: LandingTarget | None = None  # with PRECISION_LAND; None: out of sight
