"""Large numbers of correct frames through both packages, compared message by message.

`make differential FRAMES=10000000` runs this on all processors; `make test` runs a few hundred
thousand. A share of work is named by its seed alone, so a difference found in a long run is
reproduced by that one share.
"""

from __future__ import annotations

import argparse
import importlib
import os
import time
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from types import ModuleType
from typing import Any

from differential import observe
from differential.frames import KEY, FrameMaker, Framing, layouts

BATCH = 500


@dataclass(frozen=True)
class Setting:
    """Which module parses which frames: both wire versions cross over."""

    dialect: str
    module: str  # v10 or v20: the parsing module
    source: str  # v10 or v20: the module whose layouts the frames have
    framing: Framing
    keyed: bool = False

    def __str__(self) -> str:
        signed = " signed" if self.framing.key else ""
        verified = " verified" if self.keyed else ""
        return (
            f"{self.dialect}: v{self.framing.version} frames{signed} into {self.module}{verified}"
        )


SETTINGS = (
    Setting("all", "v20", "v20", Framing(2)),
    Setting("all", "v10", "v10", Framing(1)),
    Setting("all", "v10", "v20", Framing(2)),
    Setting("all", "v20", "v10", Framing(1)),
    Setting("all", "v20", "v20", Framing(2, KEY)),
    Setting("all", "v20", "v20", Framing(2, KEY), keyed=True),
    Setting("python_array_test", "v20", "v20", Framing(2)),
)


@dataclass
class Share:
    """One piece of work, small enough to hand to a process."""

    setting: Setting
    seed: int
    frames: int
    subject: str = "mavwire"
    oracle: str = "pymavlink"


class Difference(AssertionError):
    """The two packages answered differently."""


def _module(package: str, wire: str, dialect: str) -> ModuleType:
    return importlib.import_module(f"{package}.dialects.{wire}.{dialect}")


def compare_share(share: Share) -> int:
    """Compare one share; the number of frames compared, or `Difference`."""
    setting = share.setting
    maker = FrameMaker(share.seed, setting.framing)
    every = layouts(_module(share.oracle, setting.source, setting.dialect))
    parsers = []
    for package in (share.subject, share.oracle):
        mav = _module(package, setting.module, setting.dialect).MAVLink(None)
        mav.signing.secret_key = KEY if setting.keyed else None
        parsers.append(mav)
    where = f"{setting}, seed {share.seed}"
    for batch in _batches(maker.frames(every, share.frames)):
        compare_batch(where, batch, *parsers)
    return share.frames


def _batches(frames: Iterator[bytes]) -> Iterator[list[bytes]]:
    batch: list[bytes] = []
    for frame in frames:
        batch.append(frame)
        if len(batch) == BATCH:
            yield batch
            batch = []
    if batch:
        yield batch


def compare_batch(where: str, frames: list[bytes], subject: Any, oracle: Any) -> None:
    """Feed the same bytes to both parsers and compare all that comes out of them."""
    stream = b"".join(frames)
    ours, theirs = subject.parse_buffer(stream), oracle.parse_buffer(stream)
    _same(where, stream, observe.parser(subject), observe.parser(oracle))
    _same(where, stream, len(ours), len(theirs))
    _same(where, stream, len(ours), len(frames))
    for frame, our, their in zip(frames, ours, theirs, strict=True):
        _same(where, frame, observe.message(our), observe.message(their))
        _same(where, frame, observe.json(our), observe.json(their))
        sent = observe.reencoded(our, subject), observe.reencoded(their, oracle)
        if sent[0] != sent[1] and not _only_quieter(*sent, oracle):
            _same(where, frame, *sent)
    subject.seq = oracle.seq = 0


def _only_quieter(ours: Any, theirs: Any, oracle: Any) -> bool:
    """A signalling NaN turns quiet on its way through a C double; mavwire keeps its bits."""
    if not (isinstance(ours, bytes) and isinstance(theirs, bytes) and len(ours) == len(theirs)):
        return False
    body = zip(ours[:-2], theirs[:-2], strict=True)
    if any(our ^ their not in (0, 0x40) for our, their in body):
        return False
    fresh = type(oracle)(None)  # has no key; decoding checks the checksums
    decoded = [fresh.decode(bytearray(frame)) for frame in (ours, theirs)]
    return "nan" in str(decoded[0]) and str(decoded[0]) == str(decoded[1])


def _same(where: str, frame: bytes, subject: object, oracle: object) -> None:
    if subject != oracle:
        found = observe.difference(subject, oracle)
        raise Difference(f"{where}, {found}\n frame   {frame.hex()[:700]}")


def shares(frames: int, size: int, subject: str, oracle: str) -> Iterator[Share]:
    """Cut a number of frames into shares, going through the settings in turn."""
    seed = 0
    while frames > 0:
        yield Share(SETTINGS[seed % len(SETTINGS)], seed, min(size, frames), subject, oracle)
        frames -= size
        seed += 1


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=int(os.environ.get("FRAMES", "300000")))
    parser.add_argument("--share", type=int, default=10_000, help="frames in one piece of work")
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--subject", default="mavwire")
    parser.add_argument("--oracle", default="pymavlink")
    args = parser.parse_args()
    began, done = time.monotonic(), 0
    work = shares(args.frames, args.share, args.subject, args.oracle)
    with ProcessPoolExecutor(args.jobs) as pool:
        for count in pool.map(compare_share, work):
            done += count
            rate = done / (time.monotonic() - began)
            print(f"\r{done:,} of {args.frames:,} frames, {rate:,.0f}/s", end="", flush=True)
    seconds = time.monotonic() - began
    print(
        f"\n{done:,} frames compared between {args.subject} and {args.oracle} in {seconds:.0f} s:"
        " no difference"
    )
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
