"""Spectra of the batches of fast samples in dataflash logs (mavfft_isb.py)."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from typing import Any

from mavwire.cli._batches import AXES, GYRO, TYPES, Spectrum, batches
from mavwire.cli._errors import CommandError
from mavwire.cli._output import open_figures
from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared

# Units of the axis, by sensor and --output.
UNITS = {
    (False, "psd"): "m^2/s^4/Hz", (False, "lsd"): r"m/s^2/\sqrt{Hz}",
    (True, "psd"): "d^2/s^2/Hz", (True, "lsd"): r"d/s/\sqrt{Hz}",
}  # fmt: skip


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs", "condition")
    add = parser.add_argument
    add("--scale", choices=("db", "linear"), default="db", help="(default: %(default)s)")
    add("--window", choices=("hanning", "blackman", "None"), default="hanning", help="(hanning)")
    add("--overlap", action="store_true", help="windows that overlap by half")
    add("--output", choices=("psd", "lsd"), default="psd", help="power or linear density (psd)")
    add("--notch-params", action="store_true", help="tell where a harmonic notch belongs")
    add("--notch-peak", type=int, default=0, metavar="N", help="the peak for it, 0 is the highest")
    add("--axis", default=AXES, help="axes to draw (default: %(default)s)")
    add("--max-freq", type=float, metavar="HZ", help="draw no higher frequencies")
    add_shared(parser, "image")


def main(args: Namespace) -> int:
    axes = args.axis.upper()
    if not axes or set(axes) - set(AXES):
        raise CommandError(f"--axis {args.axis}: some of {AXES}")
    figures = open_figures(args.image)
    spectra: dict[tuple[int, int], Spectrum] = {}

    def read(log: Reading) -> None:
        for batch in batches(log.messages(TYPES, args.condition)):
            if batch.sensor not in spectra:
                spectra[batch.sensor] = Spectrum(args.window, args.overlap)
            spectra[batch.sensor].add(batch)

    read_each("fft_isb", args, read)
    count = sum(one.count for one in spectra.values())
    print(f"Extracted {count} fft data sets", file=sys.stderr)
    if not count:
        raise CommandError("there is nothing to draw: no complete ISBH and ISBD batch in the logs")
    for (kind, number), spectrum in spectra.items():
        name = f"{'Gyro' if kind == GYRO else 'Accel'}[{number}]"
        print(f"Sensor: {name}")
        if args.notch_params:
            _tell_notch(spectrum, args.notch_peak)
        _draw(figures.figure(name), spectrum, kind == GYRO, axes, args)
    figures.finish()
    return 0


def _shown(spectrum: Spectrum, axis: int, args: Namespace) -> Any:
    """The density of an axis as --output and --scale want it."""
    import numpy as np

    power = spectrum.density(axis)
    shown = power if args.output == "psd" else np.sqrt(power)
    if args.scale == "linear":
        return shown
    with np.errstate(divide="ignore"):  # ten times the logarithm of either, as the script has it
        return 10.0 * np.log10(shown)


def _draw(figure: Any, spectrum: Spectrum, gyro: bool, axes: str, args: Namespace) -> None:
    plot = figure.gca()
    for axis in axes:
        plot.plot(spectrum.frequencies(), _shown(spectrum, AXES.index(axis), args), label=axis)
    plot.set_xlabel("Hz")
    decibel = "dB " if args.scale == "db" else ""
    plot.set_ylabel(f"{args.output.upper()} ${decibel}{UNITS[gyro, args.output]}$")
    if args.max_freq:
        plot.set_xlim(0, args.max_freq)
    plot.legend(loc="upper right")


def _tell_notch(spectrum: Spectrum, number: int) -> None:
    """Where one of the peaks is, counted from the highest, and how wide it is at half its power."""
    import numpy as np

    power = sum(spectrum.density(axis) for axis in range(len(AXES)))
    inner = power[1:-1]
    peaks = np.flatnonzero((inner > power[:-2]) & (inner >= power[2:])) + 1
    if not 0 <= number < len(peaks):
        raise CommandError(f"--notch-peak {number}: there are {len(peaks)} peaks, from 0 on")
    at = int(peaks[np.argsort(-power[peaks], kind="stable")[number]])
    below = np.flatnonzero(power < power[at] / 2)
    low, high = below[below < at].max(initial=0), below[below > at].min(initial=len(power) - 1)
    frequencies = spectrum.frequencies()
    centre, width = frequencies[at], frequencies[high] - frequencies[low]
    print(f"Peak {number}: {centre:.1f} Hz, {width:.1f} Hz wide")
    print(f"INS_HNTCH_FREQ {centre:.1f}")
    print(f"INS_HNTCH_BW {max(centre / 2, width):.1f}")
