"""Three-dimensional vectors, rotation matrices, and the planes and lines they meet.

The same names and conventions as ``pymavlink.rotmat``: right-handed axes (north, east, down for
earth; forward, right, down for body), angles in radians, a matrix stored as the rows ``a``, ``b``
and ``c`` and turning a body vector into an earth vector. Every component is a ``float``.
"""

from __future__ import annotations

from math import acos, asin, atan2, cos, pi, radians, sin, sqrt
from typing import Any, overload


def _clamped(value: float) -> float:
    """``value`` within [-1, 1], for rounding can push a cosine out of the domain of acos; NaN stays."""
    return min(max(value, -1.0), 1.0)


class Vector3:
    """A vector of three floats; ``Vector3()`` is zero, ``Vector3([x, y, z])`` takes a sequence."""

    __hash__ = None  # type: ignore[assignment]  # equal by value and mutable

    def __init__(self, x: Any = None, y: Any = None, z: Any = None) -> None:
        if x is not None and y is not None and z is not None:
            self.x, self.y, self.z = float(x), float(y), float(z)
        elif x is not None:
            if len(x) != 3:
                raise ValueError("bad initialiser")
            self.x, self.y, self.z = float(x[0]), float(x[1]), float(x[2])
        else:
            self.x = self.y = self.z = 0.0

    def __repr__(self) -> str:
        return f"Vector3({self.x:.2f}, {self.y:.2f}, {self.z:.2f})"

    def __eq__(self, v: Any) -> bool:
        return bool(self.x == v.x and self.y == v.y and self.z == v.z)

    def close(self, v: Vector3, tol: float = 1e-7) -> bool:
        """Whether every component is nearer than ``tol`` to that of ``v``."""
        return abs(self.x - v.x) < tol and abs(self.y - v.y) < tol and abs(self.z - v.z) < tol

    def __add__(self, v: Vector3) -> Vector3:
        return Vector3(self.x + v.x, self.y + v.y, self.z + v.z)

    __radd__ = __add__

    def __sub__(self, v: Vector3) -> Vector3:
        return Vector3(self.x - v.x, self.y - v.y, self.z - v.z)

    def __rsub__(self, v: Vector3) -> Vector3:
        return Vector3(v.x - self.x, v.y - self.y, v.z - self.z)

    def __neg__(self) -> Vector3:
        return Vector3(-self.x, -self.y, -self.z)

    @overload
    def __mul__(self, v: Vector3) -> float: ...
    @overload
    def __mul__(self, v: float) -> Vector3: ...
    def __mul__(self, v: Any) -> Any:
        """The dot product with a vector, or the vector scaled by a number."""
        if isinstance(v, Vector3):
            return self.x * v.x + self.y * v.y + self.z * v.z
        return Vector3(self.x * v, self.y * v, self.z * v)

    __rmul__ = __mul__

    def __truediv__(self, v: float) -> Vector3:
        return Vector3(self.x / v, self.y / v, self.z / v)

    __div__ = __truediv__

    def __floordiv__(self, v: float) -> Vector3:
        return Vector3(self.x // v, self.y // v, self.z // v)

    def __mod__(self, v: Vector3) -> Vector3:
        """The cross product."""
        return Vector3(
            self.y * v.z - self.z * v.y,
            self.z * v.x - self.x * v.z,
            self.x * v.y - self.y * v.x,
        )

    def __copy__(self) -> Vector3:
        return Vector3(self.x, self.y, self.z)

    copy = __copy__

    def length(self) -> float:
        return sqrt(self.x**2 + self.y**2 + self.z**2)

    def zero(self) -> None:
        """Set every component to 0."""
        self.x = self.y = self.z = 0.0

    def angle(self, v: Vector3) -> float:
        """The angle to ``v`` in radians, 0 to pi; ZeroDivisionError if either has no length."""
        return acos(_clamped((self * v) / (self.length() * v.length())))

    def normalized(self) -> Vector3:
        """A copy of length 1; ZeroDivisionError for the zero vector."""
        return self / self.length()

    def normalize(self) -> None:
        """Scale to length 1 in place; ZeroDivisionError for the zero vector."""
        unit = self.normalized()
        self.x, self.y, self.z = unit.x, unit.y, unit.z

    def rotate_by_id(self, rot_id: int) -> Vector3 | None:
        """Rotated by a board orientation (enum ROTATION); None beyond the table."""
        return None if rot_id >= len(rotations) else rotations[rot_id].r * self

    def rotate_by_inverse_id(self, rot_id: int) -> Vector3 | None:
        """The reverse of :meth:`rotate_by_id`; None beyond the table."""
        return None if rot_id >= len(rotations) else rotations[rot_id].rt * self


class Matrix3:
    """A 3x3 matrix of the rows ``a``, ``b``, ``c`` (copied), or the identity if one is missing."""

    __hash__ = None  # type: ignore[assignment]  # equal by value and mutable

    a: Vector3
    b: Vector3
    c: Vector3

    def __init__(
        self, a: Vector3 | None = None, b: Vector3 | None = None, c: Vector3 | None = None
    ) -> None:
        if a is not None and b is not None and c is not None:
            self._set_rows(a.copy(), b.copy(), c.copy())
        else:
            self.identity()

    def _set_rows(self, a: Vector3, b: Vector3, c: Vector3) -> None:
        self.a, self.b, self.c = a, b, c

    def __repr__(self) -> str:
        rows = (f"({r.x:.2f}, {r.y:.2f}, {r.z:.2f})" for r in (self.a, self.b, self.c))
        return f"Matrix3({', '.join(rows)})"

    def identity(self) -> None:
        """Become the identity, in place."""
        self._set_rows(Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1))

    def transposed(self) -> Matrix3:
        a, b, c = self.a, self.b, self.c
        return Matrix3(Vector3(a.x, b.x, c.x), Vector3(a.y, b.y, c.y), Vector3(a.z, b.z, c.z))

    def from_euler(self, roll: float, pitch: float, yaw: float) -> None:
        """Become the rotation of the Euler angles in the order yaw, pitch, roll (321)."""
        sr, cr, sp, cp, sy, cy = sin(roll), cos(roll), sin(pitch), cos(pitch), sin(yaw), cos(yaw)
        self._set_rows(
            Vector3(cp * cy, sr * sp * cy - cr * sy, cr * sp * cy + sr * sy),
            Vector3(cp * sy, sr * sp * sy + cr * cy, cr * sp * sy - sr * cy),
            Vector3(-sp, sr * cp, cr * cp),
        )

    def to_euler(self) -> tuple[float, float, float]:
        """(roll, pitch, yaw) of order 321; at gimbal lock the pitch is given as +-pi."""
        if self.c.x >= 1.0:
            pitch = pi
        elif self.c.x <= -1.0:
            pitch = -pi
        else:
            pitch = -asin(self.c.x)
        return atan2(self.c.y, self.c.z), pitch, atan2(self.b.x, self.a.x)

    def from_euler312(self, roll: float, pitch: float, yaw: float) -> None:
        """Become the rotation of the Euler angles in the order yaw, roll, pitch (312)."""
        sr, cr, sp, cp, sy, cy = sin(roll), cos(roll), sin(pitch), cos(pitch), sin(yaw), cos(yaw)
        self._set_rows(
            Vector3(cp * cy - sy * sr * sp, -cr * sy, sp * cy + cp * sr * sy),
            Vector3(cp * sy + sp * sr * cy, cr * cy, sy * sp - cp * sr * cy),
            Vector3(-sp * cr, sr, cp * cr),
        )

    def to_euler312(self) -> tuple[float, float, float]:
        """(roll, pitch, yaw) of order 312."""
        return (
            asin(_clamped(self.c.y)),
            atan2(-self.c.x, self.c.z),
            atan2(-self.a.y, self.b.y),
        )

    def determinant(self) -> float:
        return self.a * (self.b % self.c)

    def invert(self) -> Matrix3:
        """The inverse, a new matrix; ZeroDivisionError for a singular one."""
        scale = 1.0 / self.determinant()
        columns = Matrix3(self.b % self.c, self.c % self.a, self.a % self.b) * scale
        return columns.transposed()

    def __add__(self, m: Matrix3) -> Matrix3:
        return Matrix3(self.a + m.a, self.b + m.b, self.c + m.c)

    __radd__ = __add__

    def __sub__(self, m: Matrix3) -> Matrix3:
        return Matrix3(self.a - m.a, self.b - m.b, self.c - m.c)

    def __rsub__(self, m: Matrix3) -> Matrix3:
        return Matrix3(m.a - self.a, m.b - self.b, m.c - self.c)

    def __eq__(self, m: Any) -> bool:
        return bool(self.a == m.a and self.b == m.b and self.c == m.c)

    @overload
    def __mul__(self, other: Vector3) -> Vector3: ...
    @overload
    def __mul__(self, other: Matrix3 | float) -> Matrix3: ...
    def __mul__(self, other: Any) -> Any:
        """A vector turned by the matrix, the product of two matrices, or a scaled matrix."""
        if isinstance(other, Vector3):
            return Vector3(self.a * other, self.b * other, self.c * other)
        if isinstance(other, Matrix3):
            columns = other.transposed()
            return Matrix3(columns * self.a, columns * self.b, columns * self.c)
        return Matrix3(self.a * other, self.b * other, self.c * other)

    def __truediv__(self, v: float) -> Matrix3:
        return Matrix3(self.a / v, self.b / v, self.c / v)

    __div__ = __truediv__

    def __neg__(self) -> Matrix3:
        return Matrix3(-self.a, -self.b, -self.c)

    def __copy__(self) -> Matrix3:
        return Matrix3(self.a, self.b, self.c)

    copy = __copy__

    def rotate(self, g: Vector3) -> None:
        """Turn by the small body rotation ``g`` (rates times the time step), to first order."""
        # a row times the skew matrix of g is the cross product of the row and g
        self._set_rows(self.a + self.a % g, self.b + self.b % g, self.c + self.c % g)

    def _turn(self, turn: Matrix3) -> None:
        turned = self * turn
        self._set_rows(turned.a, turned.b, turned.c)

    def rotate_yaw(self, yrad: float) -> None:
        """Turn about the body's z axis, in place."""
        self.rotate_321(0.0, 0.0, yrad)

    def rotate_pitch(self, prad: float) -> None:
        """Turn about the body's y axis, in place."""
        self.rotate_321(0.0, prad, 0.0)

    def rotate_roll(self, rrad: float) -> None:
        """Turn about the body's x axis, in place."""
        self.rotate_321(rrad, 0.0, 0.0)

    def rotate_321(self, ryad: float, prad: float, yrad: float) -> None:
        """Turn by roll, pitch and yaw in the order yaw, pitch, roll, in place."""
        turn = Matrix3()
        turn.from_euler(ryad, prad, yrad)
        self._turn(turn)

    def rotate_312(self, ryad: float, prad: float, yrad: float) -> None:
        """Turn by roll, pitch and yaw in the order yaw, roll, pitch, in place."""
        turn = Matrix3()
        turn.from_euler312(ryad, prad, yrad)
        self._turn(turn)

    def normalize(self) -> None:
        """Restore orthonormal rows, in place, sharing the error between the first two.

        Raises ZeroDivisionError where a row has no length.
        """
        half_error = (self.a * self.b) * 0.5
        a = self.a - self.b * half_error
        b = self.b - self.a * half_error
        c = a % b
        self._set_rows(a.normalized(), b.normalized(), c.normalized())

    def trace(self) -> float:
        return self.a.x + self.b.y + self.c.z

    def from_axis_angle(self, axis: Vector3, angle: float) -> None:
        """Become the rotation by ``angle`` about ``axis``, which must have length 1."""
        s, c = sin(angle), cos(angle)
        x, y, z = axis.x, axis.y, axis.z
        t = 1.0 - c
        self._set_rows(
            Vector3(c + x * x * t, x * y * t - z * s, x * z * t + y * s),
            Vector3(y * x * t + z * s, c + y * y * t, y * z * t - x * s),
            Vector3(z * x * t - y * s, z * y * t + x * s, c + z * z * t),
        )

    def from_two_vectors(self, vec1: Vector3, vec2: Vector3) -> None:
        """Become the rotation of ``vec1`` to ``vec2``; about the z axis where they are parallel."""
        angle = vec1.angle(vec2)
        axis = vec1 % vec2
        if axis.length() == 0:
            self.from_euler(0, 0, angle)
        else:
            self.from_axis_angle(axis.normalized(), angle)

    def close(self, m: Matrix3, tol: float = 1e-7) -> bool:
        """Whether every element is nearer than ``tol`` to that of ``m``."""
        return self.a.close(m.a, tol) and self.b.close(m.b, tol) and self.c.close(m.c, tol)


class Plane:
    """A plane through ``point`` (default: the origin) with ``normal`` (default: the z axis)."""

    def __init__(self, point: Vector3 | None = None, normal: Vector3 | None = None) -> None:
        self.point = Vector3(0, 0, 0) if point is None else point
        self.normal = Vector3(0, 0, 1) if normal is None else normal


class Line:
    """A line through ``point`` (default: the origin) along ``vector`` (default: the z axis)."""

    def __init__(self, point: Vector3 | None = None, vector: Vector3 | None = None) -> None:
        self.point = Vector3(0, 0, 0) if point is None else point
        self.vector = Vector3(0, 0, 1) if vector is None else vector

    def plane_intersection(self, plane: Plane, forward_only: bool = False) -> Vector3 | None:
        """The point on ``plane``; None where parallel, or behind the start if ``forward_only``."""
        slope = self.vector * plane.normal
        if slope == 0:
            return None
        distance = ((plane.point - self.point) * plane.normal) / slope
        if forward_only and distance < 0:
            return None
        return self.point + self.vector * distance


class Rotation:
    """One board orientation: its name, Euler angles in degrees, matrix ``r`` and inverse ``rt``."""

    def __init__(self, name: str, roll: float, pitch: float, yaw: float) -> None:
        self.name, self.roll, self.pitch, self.yaw = name, roll, pitch, yaw
        self.r = Matrix3()
        self.r.from_euler(radians(roll), radians(pitch), radians(yaw))
        self.rt = self.r.transposed()


def _named_rotation(roll: int, pitch: int, yaw: int) -> Rotation:
    """The orientation named after its angles that are not zero, as the enum ROTATION does."""
    parts = (("ROLL", roll), ("PITCH", pitch), ("YAW", yaw))
    name = "_".join(f"{axis}_{angle}" for axis, angle in parts if angle)
    return Rotation(f"ROTATION_{name or 'NONE'}", roll, pitch, yaw)


# Indexed by the value in the enum ROTATION, the angles as roll, pitch, yaw.
_ANGLES = (
    *((0, 0, yaw) for yaw in range(0, 360, 45)),
    *((180, 0, 0), (180, 0, 45), (180, 0, 90), (180, 0, 135)),
    *((0, 180, 0), (180, 0, 225), (180, 0, 270), (180, 0, 315)),
    *((90, 0, 0), (90, 0, 45), (90, 0, 90), (90, 0, 135)),
    *((270, 0, 0), (270, 0, 45), (270, 0, 90), (270, 0, 135)),
    *((0, 90, 0), (0, 270, 0), (0, 180, 90), (0, 180, 270)),
    *((90, 90, 0), (180, 90, 0), (270, 90, 0), (90, 180, 0), (270, 180, 0)),
    *((90, 270, 0), (180, 270, 0), (270, 270, 0), (90, 180, 90), (90, 0, 270)),
)

rotations: list[Rotation] = [
    *(_named_rotation(*angles) for angles in _ANGLES),
    # named for a yaw of 293 degrees, but turned by 270 in every release of pymavlink
    Rotation("ROTATION_ROLL_90_PITCH_68_YAW_293", 90, 68, 270),
    Rotation("ROTATION_PITCH_315", 0, 315, 0),
    Rotation("ROTATION_ROLL_90_PITCH_315", 90, 315, 0),
    Rotation("ROTATION_PITCH_7", 0, 7, 0),
]
