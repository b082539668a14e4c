"""Batches of fast samples in dataflash logs (ISBH and ISBD records), and their spectra."""

from __future__ import annotations

from array import array
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

TYPES = ("ISBH", "ISBD")
AXES = "XYZ"
ACCEL, GYRO = 0, 1
LENGTHS = range(2, 65_537)
"""Samples that a batch may have."""


@dataclass
class Batch:
    """Samples of one sensor at one rate."""

    sensor: tuple[int, int]
    """ACCEL or GYRO, and its number."""
    number: int
    multiplier: float
    length: int
    rate: float
    """Samples a second."""
    start: int
    """Time of the first sample, in microseconds."""
    values: list[list[int]] = field(default_factory=lambda: [[], [], []])
    parts: int = 0

    @property
    def complete(self) -> bool:
        """Whether all samples are there."""
        return len(self.values[0]) == self.length

    def rows(self) -> Iterator[tuple[int, float, float, float]]:
        """Each sample: its time in microseconds, and the axes in the units of the log."""
        for number, (x, y, z) in enumerate(zip(*self.values, strict=True)):
            micros = int(self.start + number * 1.0e6 / self.rate)
            yield micros, x / self.multiplier, y / self.multiplier, z / self.multiplier

    def axis(self, number: int) -> Any:
        """The samples of one axis: metres per second squared, or degrees a second."""
        import numpy as np

        values = np.array(self.values[number], float) / self.multiplier
        return np.degrees(values) if self.sensor[0] == GYRO else values


def batches(
    messages: Iterable[Any], on_hole: Callable[[Batch], None] = lambda batch: None
) -> Iterator[Batch]:
    """The complete batches of a log; one with a part missing is given to `on_hole`."""
    batch: Batch | None = None
    for msg in messages:
        if msg.get_type() == "ISBH":
            batch = begin(msg)
        elif batch is None or batch.number != msg.N or msg.seqno != batch.parts:
            if batch is not None:
                on_hole(batch)
            batch = None
        else:
            batch.parts += 1
            for row in samples(msg):
                for kept, value in zip(batch.values, row, strict=True):
                    kept.append(value)
            if batch.complete:
                yield batch
                batch = None


def samples(msg: Any) -> Iterable[tuple[int, int, int]]:
    """The samples of one part of a batch: x, y and z. Empty if they are not arrays of numbers."""
    rows = (msg.x, msg.y, msg.z)
    if not all(isinstance(row, Sequence | array) for row in rows):
        return ()
    return zip(*rows, strict=False)


def begin(msg: Any) -> Batch | None:
    """A batch that begins; None for one that makes no sense."""
    good = msg.type in (ACCEL, GYRO) and msg.mul > 0 and 1e-3 < msg.smp_rate < 1e7
    if not good or msg.smp_cnt not in LENGTHS:
        return None
    sensor = (msg.type, msg.instance)
    return Batch(sensor, msg.N, float(msg.mul), msg.smp_cnt, float(msg.smp_rate), int(msg.SampleUS))


def density(values: Any, rate: float, window: str) -> Any:
    """The power spectral density of evenly spaced values, without its first and its last number.

    `window` is "hanning" or "blackman", any other text for none; `rate` is in Hz.
    """
    import numpy as np

    shape = {"hanning": np.hanning, "blackman": np.blackman}.get(window, np.ones)(len(values))
    power = 2.0 * np.abs(np.fft.rfft(values * shape)) ** 2 / (rate * (shape**2).sum())
    power[0] = power[-1] = 0.0
    return power


class Spectrum:
    """The power spectral density of one sensor, averaged over its batches.

    `window` is that of `density`. `overlap` takes the batches as one row of samples and
    moves by half a batch.
    """

    def __init__(self, window: str, overlap: bool) -> None:
        self._window = window
        self._overlap = overlap
        self._rows: list[list[Any]] = [[], [], []]
        self._power: list[Any] = [0.0, 0.0, 0.0]
        self.rate = 0.0
        self.length = 0
        self.count = 0
        """Spectra that the average is of."""

    def add(self, batch: Batch) -> None:
        """Take in a batch; one of another length or rate than the first is left out."""
        if not self.length:
            self.length, self.rate = batch.length, batch.rate
        if (batch.length, batch.rate) != (self.length, self.rate):
            return
        for number in range(len(AXES)):
            row = self._rows[number]
            row.append(batch.axis(number))
            if self._overlap and len(row) > 1:
                self._add_between(number, row)
            self._power[number] = self._power[number] + density(row[-1], self.rate, self._window)
            del row[:-1]
        self.count += 1 + (self._overlap and self.count > 0)

    def _add_between(self, number: int, row: list[Any]) -> None:
        """The samples from the middle of one batch to that of the next."""
        import numpy as np

        half = self.length // 2
        between = np.concatenate((row[-2][half:], row[-1][:half]))[: self.length]
        if len(between) == self.length:
            self._power[number] = self._power[number] + density(between, self.rate, self._window)

    def frequencies(self) -> Any:
        """Of the densities, in Hz."""
        import numpy as np

        return np.fft.rfftfreq(self.length, 1.0 / self.rate)

    def density(self, axis: int) -> Any:
        """Power by frequency of an axis, in the square of its unit per Hz."""
        return self._power[axis] / self.count
