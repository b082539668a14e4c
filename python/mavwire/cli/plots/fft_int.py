"""Accelerometers and gyroscopes over time, and the spectrum of the stretch that is selected with the
mouse (mavfft_int.py).
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from typing import TYPE_CHECKING, Any

from mavwire.cli._errors import CommandError
from mavwire.cli._output import open_figures
from mavwire.cli._reading import read_each
from mavwire.cli._shared_arguments import add_shared
from mavwire.cli.plots.fft import SENSORS, Samples, read_samples

if TYPE_CHECKING:
    from mavwire.plots.windows import Figures


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs", "condition")
    add = parser.add_argument
    add("--from", dest="start", type=float, help="select from this many seconds after boot")
    add("--to", dest="end", type=float, help="select to this many seconds after boot")
    add_shared(parser, "image")


def main(args: Namespace) -> int:
    figures = open_figures(args.image)
    samples: dict[str, Samples] = {}
    read_each("fft_int", args, lambda log: read_samples(log, samples, args.condition))
    if not samples:
        raise CommandError(f"there is nothing to draw: no {', '.join(SENSORS)} in the logs")
    # matplotlib itself does not keep what selects alive.
    selections = [Selection(figures, name, samples[name]) for name in sorted(samples)]
    drawn = [one.begin(args.start, args.end) for one in selections]
    if not any(drawn):
        if args.start is not None or args.end is not None:
            raise CommandError("too few samples for a spectrum between --from and --to")
        if args.image:
            raise CommandError("there is nothing to draw: too few samples for a spectrum")
    figures.finish()
    return 0


class Selection:
    """One sensor over time, and below it the spectrum of what is selected."""

    def __init__(self, figures: Figures, name: str, samples: Samples) -> None:
        self._samples = samples
        self._figure = figures.figure(name)
        self._over_time, self._spectrum = self._figure.subplots(2)
        for axis, values in samples.values.items():
            self._over_time.plot(samples.seconds, values, label=f"{name}.{axis}")
        self._over_time.set_xlabel("seconds")
        self._over_time.legend(loc="upper right")
        self._selector: Any = None

    def begin(self, start: float | None, end: float | None) -> bool:
        """Show the spectrum of a stretch, all of it for None, and wait for the mouse; whether there is
        one.
        """
        from matplotlib.widgets import SpanSelector

        seconds = self._samples.seconds
        first, last = seconds[0] if start is None else start, seconds[-1] if end is None else end
        self._selector = SpanSelector(self._over_time, self.select, "horizontal", useblit=True)
        return self.select(first, last)

    def select(self, start: float, end: float) -> bool:
        """Show the spectrum from one time to another; nothing changes where there are no samples."""
        spectra = self._samples.between(start, end).spectra(0)
        if not spectra:
            return False
        self._spectrum.clear()
        for axis, (frequencies, values) in spectra.items():
            self._spectrum.plot(frequencies, values, label=axis)
        self._spectrum.set_xlabel("Hz")
        self._spectrum.set_title(f"{start:.3f} s to {end:.3f} s")
        self._spectrum.legend(loc="upper right")
        self._figure.canvas.draw_idle()
        return True
