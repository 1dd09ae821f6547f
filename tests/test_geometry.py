"""Rotations and transforms against scipy, over all of SO(3)."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation

from missionkit import geometry
from missionkit.geometry import Transform

coordinates = st.floats(-100, 100, allow_subnormal=False)
vectors = arrays(float, 3, elements=coordinates)
turns = arrays(float, 3, elements=st.floats(-1.8, 1.8, allow_subnormal=False))  # |φ| < π
quaternions = turns.map(geometry.exp)
transforms = st.builds(Transform, quaternions, vectors)


def peer(q):
    return Rotation.from_quat(q, scalar_first=True)


@given(turns)
def test_exponential(phi):
    np.testing.assert_allclose(
        geometry.to_matrix(geometry.exp(phi)), Rotation.from_rotvec(phi).as_matrix(), atol=1e-12
    )


@given(turns)
def test_logarithm_inverts_the_exponential(phi):
    q = geometry.exp(phi)
    np.testing.assert_allclose(geometry.log(q), phi, atol=1e-9)
    np.testing.assert_allclose(geometry.log(-q), phi, atol=1e-9)


@pytest.mark.parametrize("size", [0.0, 1e-300, 1e-12, 1e-8, 1e-6, 1e-4])
def test_small_turns_are_exact(size):
    phi = size * np.array([0.6, 0.0, -0.8])
    np.testing.assert_allclose(geometry.log(geometry.exp(phi)), phi, rtol=1e-9)


@given(quaternions, quaternions, vectors)
def test_product_and_action(p, q, v):
    np.testing.assert_allclose(
        geometry.to_matrix(geometry.multiply(p, q)), (peer(p) * peer(q)).as_matrix(), atol=1e-12
    )
    np.testing.assert_allclose(geometry.rotate(q, v), peer(q).apply(v), atol=1e-10)
    np.testing.assert_allclose(
        geometry.rotate(geometry.conjugate(q), geometry.rotate(q, v)), v, atol=1e-10
    )


@given(st.one_of(quaternions, st.sampled_from([np.eye(4)[i] for i in range(4)])))
def test_matrix_there_and_back(q):
    back = geometry.from_matrix(geometry.to_matrix(q))
    assert abs(back @ q) == pytest.approx(1.0, abs=1e-12)
    assert back[0] >= 0


angles = st.floats(-3.1, 3.1, allow_subnormal=False)


@given(angles, st.floats(-1.5, 1.5, allow_subnormal=False), angles)
def test_euler_angles(roll, pitch, yaw):
    q = geometry.from_euler(roll, pitch, yaw)
    expected = Rotation.from_euler("ZYX", [yaw, pitch, roll]).as_matrix()
    np.testing.assert_allclose(geometry.to_matrix(q), expected, atol=1e-12)
    np.testing.assert_allclose(geometry.to_euler(q), [roll, pitch, yaw], atol=1e-6)
    assert geometry.yaw_of(q) == pytest.approx(yaw, abs=1e-6)


def test_heading_is_clockwise_from_north():
    east = geometry.from_euler(0, 0, math.pi / 2)
    np.testing.assert_allclose(geometry.rotate(east, geometry.vec(1, 0, 0)), [0, 1, 0], atol=1e-12)


@given(st.floats(-1e3, 1e3))
def test_wrap(angle):
    wrapped = geometry.wrap(angle)
    assert -math.pi <= wrapped < math.pi
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-9)
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-9)


@given(vectors, vectors)
def test_skew_is_the_cross_product(u, v):
    np.testing.assert_allclose(geometry.skew(u) @ v, np.cross(u, v), atol=1e-9)
    assert geometry.norm(u) == pytest.approx(np.linalg.norm(u))


@given(quaternions.map(lambda q: 3.0 * q))
def test_normalised(q):
    assert np.linalg.norm(geometry.normalised(q)) == pytest.approx(1.0)


@given(transforms, transforms, vectors)
def test_transforms_form_a_group(a, b, point):
    np.testing.assert_allclose((a @ b).apply(point), a.apply(b.apply(point)), atol=1e-9)
    np.testing.assert_allclose(a.inverse().apply(a.apply(point)), point, atol=1e-9)
    nothing = a @ a.inverse()
    np.testing.assert_allclose(nothing.translation, 0, atol=1e-9)
    np.testing.assert_allclose(geometry.log(nothing.rotation), 0, atol=1e-7)
