"""The batches of fast samples in dataflash logs, as a CSV file for each sensor (isb_extract.py)."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, Namespace
from contextlib import ExitStack

from mavwire.cli._batches import TYPES, Batch, batches
from mavwire.cli._output import OutputFile, writing
from mavwire.cli._reading import Reading, read_each
from mavwire.cli._shared_arguments import add_shared

NAMES = ("Accel", "Gyro")


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs", "condition")


def main(args: Namespace) -> int:
    """Run the subcommand. The files (Accel0.csv ...) are in the working folder."""
    files: dict[tuple[int, int], OutputFile] = {}
    with ExitStack() as stack:

        def extract(log: Reading) -> int:
            count = 0
            for batch in batches(log.messages(TYPES, args.condition), _tell_hole):
                kind, number = batch.sensor
                if batch.sensor not in files:
                    file = writing(f"{NAMES[kind]}{number}.csv", args.logs, option="")
                    files[batch.sensor] = stack.enter_context(file)
                    files[batch.sensor].write(b"SampleUS,X,Y,Z\n")
                files[batch.sensor].write(_lines(batch))
                count += 1
            return count

        count = sum(read_each("isb_extract", args, extract))
    print(f"Extracted {count} fft data sets", file=sys.stderr)
    return 0


def _tell_hole(batch: Batch) -> None:
    print(f"ISBH({batch.number}) has holes in it")


def _lines(batch: Batch) -> bytes:
    lines = [f"{micros},{x:.5f},{y:.5f},{z:.5f}\n" for micros, x, y, z in batch.rows()]
    return "".join(lines).encode()
