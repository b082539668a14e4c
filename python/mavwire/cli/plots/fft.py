"""The spectra of accelerometers and gyroscopes in dataflash logs (mavfft.py)."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from typing import Any

from mavwire.cli._errors import CommandError
from mavwire.cli._output import open_figures
from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared

SENSORS = ("ACC1", "ACC2", "ACC3", "GYR1", "GYR2", "GYR3")
# Newer logs have one type for all sensors, which are counted from 0 in its field I.
TYPES = (*SENSORS, "ACC", "GYR")
AXES = ("X", "Y", "Z")


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs", "condition")
    parser.add_argument(
        "--sample-length", type=int, default=0, help="samples of each FFT (default: all at once)"
    )
    add_shared(parser, "image")


def main(args: Namespace) -> int:
    if args.sample_length < 0:
        raise CommandError("--sample-length is a number of samples, or 0 for all")
    figures = open_figures(args.image)
    samples: dict[str, Samples] = {}

    def read(log: Reading) -> None:
        count = read_samples(log, samples, args.condition)
        print(f"Extracted {count} data points")

    read_each("fft", args, read)
    drawn = {name: samples[name].spectra(args.sample_length) for name in sorted(samples)}
    if not any(drawn.values()):
        raise CommandError(f"there is nothing to draw: no {', '.join(SENSORS)} in the logs")
    for name, spectra in drawn.items():
        if spectra:
            axes = figures.figure(name).gca()
            for axis, (frequencies, values) in spectra.items():
                axes.plot(frequencies, values, label=f"{name}.{name[:3].title()}{axis}")
            axes.legend(loc="upper right")
    figures.finish()
    return 0


def read_samples(log: Reading, samples: dict[str, Samples], condition: str | None) -> int:
    """Add the samples of a log to those of each sensor. Returns the number of accelerometer samples."""
    count = 0
    for msg in log.messages(TYPES, condition):
        kind = str(msg.get_type())
        name = kind if kind in SENSORS else f"{kind}{getattr(msg, 'I', -1) + 1}"
        if name in SENSORS:
            samples.setdefault(name, Samples()).add(msg)
            count += name.startswith("ACC")
    return count


class Samples:
    """The measurements of one sensor on its three axes."""

    def __init__(self) -> None:
        self.seconds: list[float] = []
        self.values: dict[str, list[float]] = {axis: [] for axis in AXES}

    def add(self, msg: Any) -> None:
        """One sample."""
        prefix = msg.get_type()[:3].title()
        self.seconds.append(msg.SampleUS * 1.0e-6)
        for axis, values in self.values.items():
            values.append(getattr(msg, prefix + axis))

    def between(self, start: float, end: float) -> Samples:
        """Those from one time to another, in seconds."""
        found = Samples()
        chosen = [i for i, one in enumerate(self.seconds) if start <= one <= end]
        found.seconds = [self.seconds[i] for i in chosen]
        found.values = {axis: [all_[i] for i in chosen] for axis, all_ in self.values.items()}
        return found

    def spectra(self, length: int) -> dict[str, tuple[Any, Any]]:
        """Frequencies in Hz and amplitudes by axis, of the first `length` samples or all."""
        import numpy as np

        count = min(length, len(self.seconds)) if length else len(self.seconds)
        span = self.seconds[-1] - self.seconds[0] if self.seconds else 0.0
        if count < 2 or span <= 0:
            return {}
        rate = (len(self.seconds) - 1) / span
        frequencies = np.fft.rfftfreq(count, 1.0 / rate)
        found = {}
        for axis, all_values in self.values.items():
            values = np.array(all_values[:count])
            found[axis] = (frequencies, np.abs(np.fft.rfft(values - values.mean())))
        return found
