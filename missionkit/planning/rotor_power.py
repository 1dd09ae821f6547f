"""Electrical power of a multicopter's rotors by momentum and blade-element theory.

    P = (κ T v_i + T V_n)/η + P_0 (1 + 4.65 μ²) + P_e,   μ = V_t/(Ω R)

T is the thrust, V_n the speed of the air through the disks from above (m/s, climbing is positive)
and V_t the speed along them. The induced velocity v_i follows from Glauert,

    v_i = v_h²/sqrt(V_t² + (V_n + v_i)²),   v_h = sqrt(T/(2 ρ A)),

which fails in a steep descent, where the rotor works in its own wake. There, with m = V_n/v_h,

    v_i = G(V_t, 0) ((1 - s) D(m) + s G(v_h, V_n)/G(v_h, 0)),   s = (V_t/v_h)² <= 1,  -2 <= m <= 0,
    D(m) = 1 - 1.125 m - 1.372 m² - 1.718 m³ - 0.655 m⁴,

with G Glauert's solution: D in a vertical descent, G where the rotor leaves its wake behind (from
V_t = v_h on), continuous between them and to level flight. Below m = -2 a rotor is a windmill; v_i
is then held. Drag of the airframe counts through thrust and its tilt: T V_n holds what it takes.

Sources: correction P3.6; Leishman, "Principles of Helicopter Aerodynamics", 2nd edition, 2.13
(descent) and 5.4 (4.65 μ²). What lies between V_t = 0 and v_h is ours: no form is agreed on.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from missionkit.geometry import GRAVITY, Mat, Vec3
from missionkit.jit import compiled
from missionkit.units import Fraction, Metres, MetresPerSecond, Number

AIR_DENSITY = 1.225  # kg/m³
NEWTON_STEPS = 40  # of Newton's method at most
AT_REST = 1e-9  # N; the induced velocity of less is lost in rounding
ADVANCE = 4.65  # of the profile power, by μ²
WINDMILL_BEGINS = -2.0  # V_n/v_h, where the windmill begins


class RotorModel(NamedTuple):
    """Constants of one rotor (SI); an `area` of 0 stands for none."""

    area: float = 0.0  # m², of the disk
    induced: float = 1.0  # κ
    efficiency: float = 1.0  # η
    profile: float = 0.0  # W
    tip_speed: float = 1.0  # m/s
    electronics: float = 0.0  # W


class RotorPower(BaseModel):
    """Four rotors and what turns them, for the power that flight takes.

    The defaults are those of 9-inch rotors; with 1.2 kg they take 142 W in a hover and, where the
    airframe's drag is 0.0118 N/(m/s)², 104 W at 9 m/s.
    """

    model_config = ConfigDict(frozen=True, defer_build=True, extra="forbid", allow_inf_nan=False)

    diameter: Metres = Field(default=0.2286, gt=0, description="of one rotor")
    induced: Number = Field(default=1.15, ge=1, description="κ, losses of the induced flow")
    efficiency: Fraction = Field(default=0.6, gt=0, description="η, motor and controller")
    profile: Number = Field(default=15.0, ge=0, description="W, P_0, drag of all blades in a hover")
    tip_speed: MetresPerSecond = Field(default=64.0, gt=0, description="ΩR")
    electronics: Number = Field(default=5.0, ge=0, description="W, P_e")

    def model(self) -> RotorModel:
        """Return the constants of one of the four rotors."""
        area = 0.25 * math.pi * self.diameter * self.diameter
        profile, rest = 0.25 * self.profile, 0.25 * self.electronics
        return RotorModel(area, self.induced, self.efficiency, profile, self.tip_speed, rest)

    def hover(self, mass: float) -> float:
        """Return the power (W) of a hover in still air at that mass (kg)."""
        return 4.0 * rotor_power(0.25 * mass * GRAVITY, 0.0, 0.0, self.model())


@compiled
def descent_ratio(m: float) -> float:
    """Return D, v_i/v_h of a vertical descent at m = V_n/v_h, -2 <= m <= 0."""
    return 1.0 + m * (-1.125 + m * (-1.372 + m * (-1.718 - 0.655 * m)))


@compiled
def glauert(hover: float, along: float, through: float) -> float:
    """Return G, the induced velocity (m/s) by Glauert's equation, with Newton's method.

    f = v² (V_t² + (V_n + v)²) - v_h⁴ has one root v > 0 where V_n >= -sqrt(8) V_t. The search comes
    down from the root at V_t = 0, v = -V_n/2 + sqrt(V_n²/4 + v_h²), which is never smaller.

    Args:
        hover: v_h (m/s).
        along: V_t (m/s).
        through: V_n (m/s).
    """
    v = -0.5 * through + math.sqrt(0.25 * through * through + hover * hover)
    for _ in range(NEWTON_STEPS):
        w = through + v
        wake = along * along + w * w
        step = (v * v * wake - hover**4) / (2.0 * v * (wake + v * w))
        v -= step
        if abs(step) <= 1e-12 * v:
            break
    return v


@compiled
def induced_velocity(thrust: float, along: float, through: float, area: float) -> float:
    """Return v_i (m/s) of one rotor, see the module.

    Args:
        thrust: T > 0 (N).
        along: V_t (m/s), the air's speed along the disk.
        through: V_n (m/s), the air's speed down through the disk.
        area: of the disk (m²).
    """
    hover = math.sqrt(thrust / (2.0 * AIR_DENSITY * area))
    through = max(WINDMILL_BEGINS * hover, through)
    if through >= 0.0 or along >= hover:
        return glauert(hover, along, through)
    s = (along / hover) ** 2
    ahead = glauert(hover, hover, through) / glauert(hover, hover, 0.0)
    mixed = (1.0 - s) * descent_ratio(through / hover) + s * ahead
    return glauert(hover, along, 0.0) * mixed


@compiled
def rotor_power(thrust: float, along: float, through: float, rotor: RotorModel) -> float:
    """Return the electrical power (W) of one rotor: it never charges the battery.

    One that stands still takes what its electronics take.

    Args:
        thrust: T (N).
        along: V_t (m/s), the air's speed along the disk.
        through: V_n (m/s), the air's speed down through the disk.
        rotor: constants.
    """
    if not thrust > AT_REST:
        return rotor.electronics
    v = induced_velocity(thrust, along, through, rotor.area)
    shaft = thrust * (rotor.induced * v + through) / rotor.efficiency
    advance = along / rotor.tip_speed
    blades = rotor.profile * (1.0 + ADVANCE * advance * advance)
    return max(0.0, shaft + blades) + rotor.electronics


@compiled
def rotor_powers(thrust: Vec3, along: Vec3, through: Vec3, rotor: RotorModel) -> Vec3:
    """Return `rotor_power` (n,), W, of n flight conditions, each an array (n,).

    Args:
        thrust: (n,), N, of one rotor.
        along: (n,), m/s, the air's speed along the disk.
        through: (n,), m/s, the air's speed down through the disk.
        rotor: constants.
    """
    out = np.empty(len(thrust))
    for n in range(len(thrust)):
        out[n] = rotor_power(thrust[n], along[n], through[n], rotor)
    return out


@compiled
def flight_powers(
    velocity: Mat, acceleration: Mat, mass: float, drag: float, rotor: RotorModel
) -> Vec3:
    """Return the power (n,), W, of all four rotors of a vehicle that flies so through still air.

    T = m (a - g e3) + D is what the rotors give, along the body's axis; D = drag |v| v.

    Args:
        velocity: (n, 3), m/s, NED, relative to the air.
        acceleration: (n, 3), m/s², NED.
        mass: kg.
        drag: of the airframe, N/(m/s)².
        rotor: constants of one rotor.
    """
    out = np.empty(len(velocity))
    for n in range(len(velocity)):
        v, a = velocity[n], acceleration[n]
        speed = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
        fn = mass * a[0] + drag * speed * v[0]
        fe = mass * a[1] + drag * speed * v[1]
        fd = mass * (a[2] - GRAVITY) + drag * speed * v[2]
        thrust = math.sqrt(fn * fn + fe * fe + fd * fd)
        through = (v[0] * fn + v[1] * fe + v[2] * fd) / max(thrust, 1e-9)
        along = math.sqrt(max(0.0, speed * speed - through * through))
        out[n] = 4.0 * rotor_power(0.25 * thrust, along, through, rotor)
    return out
