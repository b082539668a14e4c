"""The spectra of the terms of PID controllers in dataflash logs (mavfft_pid.py)."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from typing import Any

from mavwire.cli._batches import density
from mavwire.cli._errors import CommandError
from mavwire.cli._output import open_figures
from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared

CONTROLLERS = ("PIDR", "PIDP", "PIDY")
TERMS = ("P", "I", "D", "Tar", "Err")
# Added to densities, so that there is a logarithm of none.
FLOOR = 1e-5
RATES = range(4, 100_001)


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs", "condition")
    parser.add_argument(
        "--sample-rate", type=int, default=400, metavar="HZ",
        help="of the records (default: %(default)s)",
    )  # fmt: skip
    add_shared(parser, "image")


def main(args: Namespace) -> int:
    rate = args.sample_rate
    if rate not in RATES:
        raise CommandError(f"--sample-rate is {RATES.start} to {RATES.stop - 1} Hz, not {rate}")
    figures = open_figures(args.image)
    rows: dict[str, list[tuple[float, ...]]] = {name: [] for name in CONTROLLERS}

    def read(log: Reading) -> None:
        for msg in log.messages(CONTROLLERS, args.condition):
            rows[msg.get_type()].append(tuple(getattr(msg, term) for term in TERMS))

    read_each("fft_pid", args, read)
    print(f"Extracted {max(map(len, rows.values()))} data points, sample rate {rate}Hz")
    drawn = {name: some for name, some in rows.items() if len(some) >= rate}
    if not drawn:
        raise CommandError(f"there is nothing to draw: no second of {', '.join(CONTROLLERS)}")
    for name, some in drawn.items():
        axes = figures.figure(name).gca()
        for term, levels in zip(TERMS, _levels(some, rate), strict=True):
            axes.plot(range(len(levels)), levels, label=f"{name}.{term}")
        axes.legend(loc="upper right")
    figures.finish()
    return 0


def _levels(rows: list[tuple[float, ...]], rate: int) -> list[Any]:
    """For each term decibels by frequency: the average of windows of one second, so that there is a
    value for each whole Hz.
    """
    import numpy as np

    values = np.array(rows, float).T
    starts = range(0, len(rows) - rate + 1, rate)
    levels = []
    for one in values:
        power = np.mean([density(one[at : at + rate], rate, "hanning") for at in starts], axis=0)
        levels.append(10.0 * np.log10(np.sqrt(power) + FLOOR))
    return levels
