"""Quaternions beside pymavlink's: the same rotations from the same random input."""

from __future__ import annotations

import math
import random
import subprocess
import sys
import warnings
from collections.abc import Callable
from typing import Any

import pytest

np = pytest.importorskip("numpy")
with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    oracle = pytest.importorskip("pymavlink.quaternion", reason="pymavlink is not installed")

from mavwire import quaternion, rotmat  # noqa: E402

Module = Any
R = random.Random(3)


def rotation_list() -> list[float]:
    values = [R.gauss(0, 1) for _ in range(4)]
    norm = math.sqrt(sum(value * value for value in values))
    return [value / norm for value in values]


def euler_list() -> list[float]:
    return [R.uniform(-3.1, 3.1), R.uniform(-1.5, 1.5), R.uniform(-3.1, 3.1)]


def any_matrix() -> Any:
    while True:
        matrix = np.array([[R.uniform(-1, 1) for _ in range(3)] for _ in range(3)])
        if np.trace(matrix) > 0:
            return matrix


def given() -> Any:
    return R.choice((rotation_list, euler_list))()


def equalities(cls: Any, q: Any) -> Any:
    opposite, nearby, other = cls(-q.q), cls(q.q + 1e-9), cls(given())
    equal = (q == cls(q.q), q == opposite, q == other)
    return *equal, q.close(nearby), q.close(opposite), q.close(other)


CASES: dict[str, Callable[[Any], Any]] = {
    "q of euler": lambda cls: cls(euler_list()).q,
    "dcm of euler": lambda cls: cls(euler_list()).dcm,
    "dcm of q": lambda cls: cls(rotation_list()).dcm,
    "euler of q": lambda cls: cls(rotation_list()).euler,
    "q of dcm": lambda cls: cls(cls(rotation_list()).dcm).q,
    "q of any matrix": lambda cls: cls(any_matrix()).q,
    "euler of any matrix": lambda cls: cls(any_matrix()).euler,
    "copy": lambda cls: cls(cls(given())).q,
    "transform": lambda cls: cls(given()).transform([R.uniform(-9, 9) for _ in range(3)]),
    "product": lambda cls: (cls(given()) * cls(given())).q,
    "quotient": lambda cls: (cls(given()) / cls(given())).q,
    "quotient by a list": lambda cls: (cls(given()) / rotation_list()).q,
    "inversed": lambda cls: cls(given()).inversed.q,
    "norm": lambda cls: cls([4 * x for x in rotation_list()]).norm,
    "normalize_array": lambda cls: cls.normalize_array([R.uniform(-9, 9) for _ in range(4)]),
    "norm_array": lambda cls: cls.norm_array([R.uniform(-9, 9) for _ in range(4)]),
    "item": lambda cls: cls(given())[R.randrange(4)],
    "equal": lambda cls: equalities(cls, cls(given())),
    "not close": lambda cls: cls(given()).close(cls(given())),
    "other types": lambda cls: (cls(given()) == 1, cls(given()) == None),  # noqa: E711
    "whole numbers": lambda cls: str(cls([1, 2, 3, 4])),
}


def plain(value: Any) -> Any:
    if hasattr(value, "c"):
        value = [[row.x, row.y, row.z] for row in (value.a, value.b, value.c)]
    return np.array(value) if not isinstance(value, str) else value


@pytest.mark.parametrize("cls", ["QuaternionBase", "Quaternion"])
@pytest.mark.parametrize("name", CASES)
def test_same_as_pymavlink(name: str, cls: str) -> None:
    R.seed(name + cls)
    for _ in range(200):
        before = R.getstate()
        theirs = CASES[name](getattr(oracle, cls))
        R.setstate(before)
        ours = CASES[name](getattr(quaternion, cls))
        assert type(ours).__name__ == type(theirs).__name__
        if isinstance(theirs, str):
            assert ours == theirs
        else:
            assert np.allclose(plain(ours), plain(theirs), rtol=1e-9, atol=1e-9)


def test_with_vectors_and_matrices() -> None:
    R.seed(5)
    for _ in range(50):
        angles, turn = euler_list(), euler_list()
        pairs = [(quaternion, rotmat), (oracle, oracle)]
        ours, theirs = (
            (
                m.Quaternion(v.Vector3(*angles)).q,
                plain(m.Quaternion(m.Quaternion(angles).dcm).q),
                m.Quaternion(angles).transform(v.Vector3(*turn)),
            )
            for m, v in pairs
        )
        assert np.allclose(ours[0], theirs[0]) and np.allclose(ours[1], theirs[1])
        assert type(ours[2]) is rotmat.Vector3
        assert math.isclose(ours[2].x, theirs[2].x) and math.isclose(ours[2].z, theirs[2].z)


def test_views_follow_what_is_set() -> None:
    q = quaternion.QuaternionBase([1, 0, 0, 0])
    assert np.allclose(q.dcm, np.eye(3)) and np.allclose(q.euler, [0, 0, 0])
    q.euler = [0.1, 0.2, 0.3]
    assert np.allclose(q.q, oracle.QuaternionBase([0.1, 0.2, 0.3]).q)
    q.dcm = np.eye(3)
    assert np.allclose(q.q, [1, 0, 0, 0])
    q.q = [0, 1, 0, 0]
    assert np.allclose(q.euler, [math.pi, 0, 0])


def test_yaw_at_gimbal_lock() -> None:
    """Nose up equals pymavlink; nose down, where pymavlink's yaw is rounding noise, is right."""
    up = [0.3, math.pi / 2, 0.4]
    assert np.allclose(
        quaternion.QuaternionBase(quaternion.QuaternionBase(up).dcm).euler,
        oracle.QuaternionBase(oracle.QuaternionBase(up).dcm).euler,
    )
    down = quaternion.QuaternionBase([0.3, -math.pi / 2, 0.4])
    again = quaternion.QuaternionBase(quaternion.QuaternionBase(down.dcm).euler)
    assert np.allclose(again.dcm, down.dcm)


@pytest.mark.parametrize("attitude", [None, 3, [1, 2], "abcd", [1, 2, 3, 4, 5], [[1, 2], [3, 4]]])
def test_refuses_what_is_no_attitude(attitude: Any) -> None:
    for cls in (quaternion.QuaternionBase, quaternion.Quaternion):
        with pytest.raises((TypeError, ValueError)):
            cls(attitude)


def test_refuses_to_turn_by_what_is_no_rotation() -> None:
    q = quaternion.QuaternionBase([1, 2, 3, 4])
    for use in (lambda: q.dcm, lambda: q.euler, lambda: q.transform([1, 2, 3])):
        with pytest.raises(ValueError, match=r"norm 1, not 5\.47723"):
            use()
    with pytest.raises(ValueError, match="shape"):
        quaternion.QuaternionBase([1, 0, 0, 0]).transform([1, 2])
    with pytest.raises(TypeError):
        q * 2


def test_import_does_not_load_numpy() -> None:
    program = "import sys, mavwire.quaternion, mavwire.mavexpression; print('numpy' in sys.modules)"
    ran = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True
    )
    assert ran.stdout.strip() == "False"
