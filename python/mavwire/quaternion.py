"""Rotations as quaternions, with pymavlink's names, on NumPy arrays.

A quaternion [w, x, y, z] of norm 1 is one of three views of the same rotation; the Euler angles
(roll, pitch, yaw in radians, order 321) and the direction cosine matrix (body to earth) are
derived on first use and kept. ``QuaternionBase`` speaks NumPy arrays, ``Quaternion`` the
``Vector3`` and ``Matrix3`` of :mod:`mavwire.rotmat`. NumPy is imported on first use.
"""

from __future__ import annotations

from math import asin, atan2, cos, pi, sin, sqrt
from typing import TYPE_CHECKING, Any, Self

from mavwire.rotmat import Matrix3, Vector3

if TYPE_CHECKING:
    import numpy as np
else:

    class _NumPyOnFirstUse:
        """A proxy of the module, so that importing this one stays cheap."""

        def __getattr__(self, name: str) -> Any:
            import numpy

            return getattr(numpy, name)

    np = _NumPyOnFirstUse()

_GIMBAL_LOCK = 1e-3  # radians from +-90 degrees of pitch where roll is taken as 0
_EPSILON = 2.0**-52  # of a double


def _array(values: Any, shape: tuple[int, ...], what: str) -> np.ndarray:
    """``values`` as a new array; ValueError where it is not a ``what`` of this shape."""
    array = np.array(values)
    if array.shape != shape or array.dtype.kind not in "biuf":
        raise ValueError(f"{what} must be numbers of shape {shape}, not of shape {array.shape}")
    return array


def from_angles(roll: float, pitch: float, yaw: float) -> tuple[float, float, float, float]:
    """The quaternion of angles in radians, w first."""
    sr, sp, sy = (sin(angle / 2) for angle in (roll, pitch, yaw))
    cr, cp, cy = (cos(angle / 2) for angle in (roll, pitch, yaw))
    return (
        cr * cp * cy + sr * sp * sy,
        sr * cp * cy - cr * sp * sy,
        cr * sp * cy + sr * cp * sy,
        cr * cp * sy - sr * sp * cy,
    )


def _euler_to_q(euler: np.ndarray) -> np.ndarray:
    """The quaternion of roll, pitch, yaw; NaN where an angle is no number."""
    if not np.isfinite(euler).all():
        return np.full(4, np.nan)
    return np.array(from_angles(*euler))


def _euler_to_dcm(euler: np.ndarray) -> np.ndarray:
    """The matrix of roll, pitch, yaw."""
    matrix = Matrix3()
    matrix.from_euler(*(float(angle) for angle in euler))
    return _matrix_to_array(matrix)


def _q_to_dcm(q: np.ndarray) -> np.ndarray:
    """The matrix of a quaternion; ValueError where its norm is not 1 within 1e-5."""
    norm = float(np.linalg.norm(q))
    if not abs(norm - 1.0) <= 1.001e-5:
        raise ValueError(f"a rotation needs a quaternion of norm 1, not {norm:g}: normalize() it")
    w, x, y, z = (float(part) for part in q)
    ww, xx, yy, zz = w * w, x * x, y * y, z * z
    return np.array(
        [
            [ww + xx - yy - zz, 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), ww - xx + yy - zz, 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), ww - xx - yy + zz],
        ]
    )


def _dcm_to_q(dcm: np.ndarray) -> np.ndarray:
    """The quaternion of a matrix (Shepperd's method, stable for any rotation)."""
    m = dcm.tolist()
    trace = m[0][0] + m[1][1] + m[2][2]
    if trace > 0:
        root = sqrt(trace + 1)
        s = 0.5 / root
        vector = [(m[2][1] - m[1][2]) * s, (m[0][2] - m[2][0]) * s, (m[1][0] - m[0][1]) * s]
        return np.array([root / 2, *vector])
    i = max(range(3), key=lambda k: m[k][k])
    j, k = (i + 1) % 3, (i + 2) % 3
    root = sqrt(m[i][i] - m[j][j] - m[k][k] + 1)
    s = 0.5 / root
    q = np.zeros(4)
    q[0] = (m[k][j] - m[j][k]) * s
    q[i + 1] = root / 2
    q[j + 1] = (m[i][j] + m[j][i]) * s
    q[k + 1] = (m[k][i] + m[i][k]) * s
    return q


def _dcm_to_euler(dcm: np.ndarray) -> np.ndarray:
    """Roll, pitch, yaw of a matrix; at gimbal lock roll is 0 and yaw holds the whole turn."""
    m = dcm.tolist()
    pitch = asin(min(max(-m[2][0], -1.0), 1.0))
    if abs(abs(pitch) - pi / 2) < _GIMBAL_LOCK:
        up = 1.0 if pitch > 0 else -1.0
        yaw = atan2(up * m[1][2] - m[0][1], up * m[0][2] + m[1][1])
        return np.array([0.0, pitch, yaw])
    return np.array([atan2(m[2][1], m[2][2]), pitch, atan2(m[1][0], m[0][0])])


def _matrix_to_array(matrix: Matrix3) -> np.ndarray:
    return np.array([[row.x, row.y, row.z] for row in (matrix.a, matrix.b, matrix.c)])


class QuaternionBase:
    """A rotation from a quaternion [w, x, y, z], Euler angles, a 3x3 matrix or another rotation.

    Raises TypeError for anything else. The quaternion is kept as given, not normalised.
    """

    __hash__ = None  # type: ignore[assignment]  # equal by orientation and mutable

    _q: np.ndarray | None
    _euler: np.ndarray | None
    _dcm: Any

    def __init__(self, attitude: Any = (1, 0, 0, 0)) -> None:
        if isinstance(attitude, QuaternionBase):
            self.q = attitude.q
            return
        shape = np.shape(attitude)
        if shape == (4,):
            self.q = attitude
        elif shape == (3,):
            self.euler = attitude
        elif shape == (3, 3):
            self._keep(dcm=self._own_dcm(_array(attitude, (3, 3), "a matrix")))
        else:
            raise TypeError("attitude is not valid")

    def _keep(
        self, q: np.ndarray | None = None, euler: np.ndarray | None = None, dcm: Any = None
    ) -> None:
        """Hold one view; the others are derived from it when asked for."""
        self._q, self._euler, self._dcm = q, euler, dcm

    @staticmethod
    def _own_dcm(dcm: np.ndarray) -> Any:
        """The matrix in the type that this class gives out."""
        return dcm

    @staticmethod
    def _array_dcm(dcm: Any) -> np.ndarray:
        """The matrix as an array, from the type that this class takes."""
        return _array(dcm, (3, 3), "a matrix")

    def _euler_of(self, dcm: Any) -> np.ndarray:
        return _dcm_to_euler(dcm)

    @property
    def q(self) -> np.ndarray:
        """The quaternion, an array [w, x, y, z]."""
        if self._q is None:
            if self._euler is not None:
                self._q = _euler_to_q(self._euler)
            else:
                self._q = _dcm_to_q(self._array_dcm(self._dcm))
        return self._q

    @q.setter
    def q(self, q: Any) -> None:
        self._keep(q=_array(q, (4,), "a quaternion"))

    def __getitem__(self, index: Any) -> Any:
        return self.q[index]

    @property
    def euler(self) -> np.ndarray:
        """Roll, pitch and yaw in radians, an array of 3."""
        if self._euler is None:
            self._euler = self._euler_of(self.dcm)
        return self._euler

    @euler.setter
    def euler(self, euler: Any) -> None:
        self._keep(euler=_array(euler, (3,), "Euler angles"))

    @property
    def dcm(self) -> Any:
        """The matrix from body to earth, an array of 3x3."""
        if self._dcm is None:
            euler = self._euler
            self._dcm = self._own_dcm(_q_to_dcm(self.q) if euler is None else _euler_to_dcm(euler))
        return self._dcm

    @dcm.setter
    def dcm(self, dcm: Any) -> None:
        self._keep(dcm=self._own_dcm(self._array_dcm(dcm)))

    def transform(self, v: Any) -> Any:
        """A vector of 3 from the body's frame in the earth's, an array."""
        vector = _array(v, (3,), "a vector")
        _q_to_dcm(self.q)  # which checks the norm
        w, u = self.q[0], self.q[1:]
        return (w * w - u.dot(u)) * vector + 2 * u.dot(vector) * u + 2 * w * np.cross(u, vector)

    @property
    def norm(self) -> Any:
        """The length of the quaternion; 1 for a rotation."""
        return QuaternionBase.norm_array(self.q)

    def normalize(self) -> None:
        """Scale the quaternion to norm 1, in place."""
        self.q = QuaternionBase.normalize_array(self.q)

    @property
    def inversed(self) -> Self:
        """The opposite rotation (the conjugate: the norm is kept)."""
        w, x, y, z = self.q
        return type(self)(np.array([w, -x, -y, -z]))

    def __eq__(self, other: object) -> bool:
        """Whether both are the same orientation; q and -q are."""
        if not isinstance(other, QuaternionBase):
            return NotImplemented
        return bool(1 - abs(self.q.dot(other.q)) < _EPSILON)

    def close(self, other: Any) -> Any:
        """Whether both are the same orientation within NumPy's default tolerance, a bool."""
        if not isinstance(other, QuaternionBase):
            return NotImplemented
        return bool(np.allclose(self.q, other.q) or np.allclose(-self.q, other.q))

    @staticmethod
    def _factor(other: Any) -> np.ndarray | None:
        """The quaternion of the other operand; None where it is none."""
        if isinstance(other, QuaternionBase):
            return other.q
        return _array(other, (4,), "a quaternion") if np.shape(other) == (4,) else None

    def __mul__(self, other: Any) -> Self:
        """The rotation ``other`` followed by this one (the Hamilton product)."""
        factor = self._factor(other)
        if factor is None:
            return NotImplemented
        return type(self)(self._mul_array(self.q, factor))

    def __truediv__(self, other: Any) -> Self:
        """The product with the inverse of ``other``."""
        factor = self._factor(other)
        if factor is None:
            return NotImplemented
        return type(self)(self._mul_array(self.q, factor * np.array([1, -1, -1, -1])))

    @staticmethod
    def _mul_array(p: np.ndarray, q: np.ndarray) -> np.ndarray:
        scalar = p[0] * q[0] - p[1:].dot(q[1:])
        vector = p[0] * q[1:] + q[0] * p[1:] + np.cross(p[1:], q[1:])
        return np.array([scalar, *vector], dtype=float)

    @staticmethod
    def normalize_array(q: Any) -> np.ndarray:
        """A list of 4 scaled to norm 1, an array; NaN for zeros."""
        scaled: np.ndarray = np.array(q) / QuaternionBase.norm_array(q)
        return scaled

    @staticmethod
    def norm_array(q: Any) -> Any:
        """The length of a list of 4."""
        return np.sqrt(np.sum(_array(q, (4,), "a quaternion").astype(float) ** 2))

    def __str__(self) -> str:
        return str(self.q)


class Quaternion(QuaternionBase):
    """A rotation that also takes a ``Vector3`` of Euler angles or a ``Matrix3``, and gives those.

    The Euler angles are those of :meth:`mavwire.rotmat.Matrix3.to_euler`.
    """

    def __init__(self, attitude: Any) -> None:
        if isinstance(attitude, Vector3):
            super().__init__([attitude.x, attitude.y, attitude.z])
        elif isinstance(attitude, Matrix3):
            self._keep(dcm=attitude)
        else:
            super().__init__(attitude)

    @staticmethod
    def _own_dcm(dcm: np.ndarray) -> Matrix3:
        return Matrix3(*(Vector3(*row) for row in dcm.tolist()))

    @staticmethod
    def _array_dcm(dcm: Any) -> np.ndarray:
        if not isinstance(dcm, Matrix3):
            raise ValueError(f"the matrix of a Quaternion must be a Matrix3, not {type(dcm)}")
        return _matrix_to_array(dcm)

    def _euler_of(self, dcm: Matrix3) -> np.ndarray:
        return np.array(dcm.to_euler())

    def transform(self, v3: Any) -> Any:
        """A vector from the body's frame in the earth's: Vector3 from Vector3, else an array."""
        if isinstance(v3, Vector3):
            return Vector3(*super().transform([v3.x, v3.y, v3.z]))
        return super().transform(v3)
