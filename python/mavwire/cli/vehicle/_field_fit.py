"""The correction of a compass that best turns what it measured into the field that was expected."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from mavwire.cli._errors import CommandError

AXES = 3
# The pairs of axes of COMPASS_ODI_X, _Y and _Z.
PAIRS = ((0, 1), (0, 2), (1, 2))
LEAST = 20
# Below this many milligauss a sample counts no more for being nearer.
NEAR = 0.1


@dataclass
class Correction:
    """corrected = matrix * (scale * (raw + offsets)) + motor * load, as ArduPilot does it; each an
    array of three, in milligauss, but for the scale. The matrix is symmetric.
    """

    offsets: Any
    diagonals: Any
    offdiagonals: Any
    motor: Any
    scale: float = 1.0

    def matrix(self) -> Any:
        """3 by 3, without the scale."""
        import numpy as np

        matrix = np.diag(self.diagonals)
        for (row, column), value in zip(PAIRS, self.offdiagonals, strict=True):
            matrix[row, column] = matrix[column, row] = value
        return matrix

    def apply(self, raw: Any, load: Any) -> Any:
        """The corrected field of n samples (n by 3) at n currents or throttles."""
        field = (raw + self.offsets) * self.scale @ self.matrix()
        return field + load[:, None] * self.motor


@dataclass
class Limits:
    """The parameters of the fit, and their limits."""

    scale: tuple[float, float] = (0.6, 1.5)
    offset: float = 1500.0
    diagonal: tuple[float, float] = (0.8, 1.2)
    offdiagonal: tuple[float, float] = (-0.2, 0.2)
    motor: float = 10.0
    elliptical: bool = False
    fit_motor: bool = False
    fit_offsets: bool = True
    rounds: int = 100


def fit(raw: Any, expected: Any, load: Any, start: Correction, limits: Limits) -> Correction:
    """The correction with the smallest mean distance from what was expected; `start` is the one in
    use. CommandError where the samples do not say enough.
    """
    import numpy as np

    if len(raw) < LEAST:
        raise CommandError(f"{len(raw)} data points are too few: {LEAST} are needed")
    found = start
    weights = np.ones(len(raw))
    for _ in range(max(1, limits.rounds)):
        before = found
        found = _within(_solve(raw, expected, load, start, limits, weights), limits)
        found = _again(raw, expected, load, found, limits, weights)
        away = np.linalg.norm(found.apply(raw, load) - expected, axis=1)
        weights = 1.0 / np.sqrt(np.maximum(away, NEAR))
        if np.abs(found.offsets - before.offsets).max() < 1e-4:
            break
    return found


def _solve(
    raw: Any, expected: Any, load: Any, start: Correction, limits: Limits, weights: Any
) -> Correction:
    """Least squares: all unknowns are linear when the scale is taken into the matrix."""
    import numpy as np

    field = raw if limits.fit_offsets else raw + start.offsets
    wanted = expected if limits.fit_motor else expected - load[:, None] * start.motor
    columns = _matrix_columns(field, limits.elliptical)
    units = [np.tile(row, len(raw)) for row in np.eye(AXES)]
    if limits.fit_offsets:
        columns += units
    if limits.fit_motor:
        columns += [one * np.repeat(load, AXES) for one in units]
    repeated = np.repeat(weights, AXES)
    system = np.column_stack(columns) * repeated[:, None]
    values, _, rank, _ = np.linalg.lstsq(system, wanted.ravel() * repeated, rcond=1e-10)
    if rank < len(values):
        raise CommandError("the data points do not tell all that is asked for: turn the vehicle"
                           " about all axes, and change its throttle for compassmot")  # fmt: skip
    return _correction(list(values), start, limits)


def _matrix_columns(field: Any, elliptical: bool) -> list[Any]:
    """The columns of the unknowns of the matrix: a scale, or six numbers."""
    import numpy as np

    if not elliptical:
        return [field.ravel()]
    columns = []
    for row, column in [(axis, axis) for axis in range(AXES)] + list(PAIRS):
        part = np.zeros_like(field)
        part[:, row] = field[:, column]
        part[:, column] = field[:, row]
        columns.append(part.ravel())
    return columns


def _correction(values: list[float], start: Correction, limits: Limits) -> Correction:
    """The unknowns of `_solve` as a correction."""
    import numpy as np

    count = 6 if limits.elliptical else 1
    numbers, rest = np.array(values[:count]), np.array(values[count:])
    scale = float(numbers[:AXES].mean())
    if abs(scale) < 1e-6:
        raise CommandError("the compass did not follow the attitude: is its orientation right?")
    diagonals, offdiagonals = np.ones(AXES), np.zeros(AXES)
    if limits.elliptical:
        diagonals, offdiagonals = numbers[:AXES] / scale, numbers[AXES:] / scale
    found = Correction(start.offsets, diagonals, offdiagonals, start.motor, scale)
    if limits.fit_offsets:
        found.offsets = np.linalg.solve(found.matrix() * scale, rest[:AXES])
        rest = rest[AXES:]
    if limits.fit_motor:
        found.motor = rest
    return found


def _within(found: Correction, limits: Limits) -> Correction:
    """Clip all values to the limits."""
    import numpy as np

    return Correction(
        np.clip(found.offsets, -limits.offset, limits.offset) if limits.fit_offsets
        else found.offsets,
        np.clip(found.diagonals, *limits.diagonal),
        np.clip(found.offdiagonals, *limits.offdiagonal),
        np.clip(found.motor, -limits.motor, limits.motor) if limits.fit_motor else found.motor,
        float(np.clip(found.scale, *limits.scale)),
    )  # fmt: skip


def _again(
    raw: Any, expected: Any, load: Any, found: Correction, limits: Limits, weights: Any
) -> Correction:
    """The offsets that go best with the other numbers, which a limit may have changed."""
    import numpy as np

    if not limits.fit_offsets:
        return found
    matrix = found.matrix() * found.scale
    field = expected - load[:, None] * found.motor
    shares = weights**2 / (weights**2).sum()
    offsets = shares @ (field @ np.linalg.inv(matrix) - raw)
    return _within(
        Correction(offsets, found.diagonals, found.offdiagonals, found.motor, found.scale), limits
    )
