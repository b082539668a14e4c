"""`mavwire dump LOG`: print the messages of a log, with the options and the output of mavlogdump.

LOG is a telemetry or dataflash log, or any link that mavutil opens (`udpin:0.0.0.0:14550`), which
`--follow` keeps reading. Most dumps of telemetry logs run in a native loop; options that need
message objects use `recv_match`. Both write the same bytes.
"""

from __future__ import annotations

import os
import sys
from argparse import ArgumentParser, Namespace
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager, redirect_stdout
from functools import partial
from typing import TYPE_CHECKING, Any

from mavwire._log_link import kind_of
from mavwire._native import StatusTexts
from mavwire._text import is_terminal, shown_to
from mavwire.cli._errors import CommandError, tell
from mavwire.cli._reading import (
    STANDARD_INPUT,
    Reading,
    definitions,
    link_options,
    reading,
    standard_input,
)
from mavwire.cli._shared_arguments import add_shared
from mavwire.cli._telemetry import record_of
from mavwire.cli.logs import _dump_format, _dump_native
from mavwire.cli.logs._dump_select import Selection, unknown_types
from mavwire.dialects import UPSTREAM

if TYPE_CHECKING:
    from mavwire.cli.logs._dump_mat import Tables


def add_arguments(parser: ArgumentParser) -> None:
    add = parser.add_argument
    add("log", metavar="LOG", help="telemetry or dataflash log, or a link; - for standard input")
    _add_input(parser.add_argument_group("reading"))
    _add_filters(parser.add_argument_group("choosing messages"))
    _add_output(parser.add_argument_group("writing"))


def _add_input(group: Any) -> None:
    add = group.add_argument
    add_shared(group, "dialect")
    add("--mav10", action="store_true", help="start with MAVLink 1 definitions")
    add_shared(group, "no_timestamps", "planner", "robust")
    add("-f", "--follow", action="store_true", help="wait for more at the end of a telemetry log")
    add("--zero-time-base", action="store_true", help="dataflash: times since start, not 1970")
    add("--profile", action="store_true", help="print a profile of the run on stderr")


def _add_filters(group: Any) -> None:
    add = group.add_argument
    add("--types", help="only these types, comma separated, with wildcards")
    add("--nottypes", help="not these types, comma separated, with wildcards")
    add_shared(group, "condition")
    add("--meta", action="store_true", help="dataflash: definitions and the like in any condition")
    add("--source-system", type=int, help="only from this system id")
    add("--source-component", type=int, help="only from this component id")
    add("--link", type=int, help="only from this link of the ground station")
    add("--no-bad-data", action="store_true", help="leave out BAD_DATA")
    add("--reduce", type=int, default=0, metavar="N", help="every Nth of the streamed sensor types")
    add("--reduce-rate", type=float, default=0, metavar="HZ", help="at most HZ of each type")


def _add_output(group: Any) -> None:
    add = group.add_argument
    formats = ("standard", "json", "csv", "mat")
    add("--format", choices=formats, default="standard", help="form of a message (default: text)")
    add("--csv_sep", default=",", help="CSV: what separates the columns; 'tab' for a tab")
    add("--csv-safe", action="store_true", help="CSV: ' before texts that a spreadsheet would run")
    add("--show-source", action="store_true", help="show system and component ids")
    add_shared(group, "event_definitions")
    add("--show-seq", action="store_true", help="show sequence numbers")
    add("--show-types", action="store_true", help="show only which types there are")
    add("--show-loss", action="store_true", help="show where messages were lost")
    add("--verbose", action="store_true", help="a line per field, with units and enum names")
    add("-q", "--quiet", action="store_true", help="print no messages")
    add("-o", "--output", metavar="FILE", help="write the matching messages to a log of their own")
    add("-p", "--parms", action="store_true", help="keep all parameters in the output of -o")
    add("--mat_file", metavar="FILE", help="mat: the file to write, a structure for each type")
    add("-c", "--compress", action="store_true", help="mat: compress the file")


def main(args: Namespace) -> int:
    writer = Writer()
    name = STANDARD_INPUT if args.log == "-" else args.log
    with ExitStack() as stack:
        if args.event_definitions and args.dialect == "ardupilotmega":
            args.dialect = UPSTREAM  # which has everything of it, and EVENT
        stack.enter_context(definitions(args.dialect, "1.0" if args.mav10 else "2.0"))
        if args.log == "-":
            if args.follow:
                raise CommandError("--follow: standard input is read to its end first")
            args.log = stack.enter_context(standard_input())
        if args.profile:
            stack.enter_context(_profiled())
        tables = _tables(args, stack)
        if not os.path.isfile(args.log):  # what a link has to say must not be among the messages
            stack.enter_context(redirect_stdout(sys.stderr))
        log = stack.enter_context(
            reading(
                "dump", args.log, show_progress=args.quiet or not writer.to_terminal,
                first_try=partial(_dump_native.open_without_index, args), name=name,
                **link_options(args),
            )
        )  # fmt: skip
        _check_possible(args, log.link, name)
        _dump(args, log, writer, _recorder(args, stack), tables)
    return 0


def _check_possible(args: Namespace, log: Any, name: str) -> None:
    """CommandError for options that dataflash and CSV logs do not support."""
    if kind_of(log) == "telemetry":
        return
    shown = not args.quiet
    text = shown and args.format == "standard" and not (args.show_types or args.verbose)
    asked = {
        "--source-system": args.source_system is not None,
        "--source-component": args.source_component is not None,
        "--link": args.link is not None,
        "--show-source": args.show_source and (text or (shown and args.format == "json")),
        "--show-seq": args.show_seq and text,
        "--show-loss": args.show_loss and shown,
        "--follow": args.follow,
        "--output": bool(args.output) and kind_of(log) == "CSV",
    }
    for option in (one for one, wanted in asked.items() if wanted):
        kind = kind_of(log)
        raise CommandError(f"{option}: {name} is a {kind} log; this is for telemetry only")


def _tables(args: Namespace, stack: ExitStack) -> Tables | None:
    if args.format != "mat":
        return None
    from mavwire.cli.logs._dump_mat import mat_file

    return stack.enter_context(mat_file(args))


def _recorder(args: Namespace, stack: ExitStack) -> Callable[[bytes], Any] | None:
    if not args.output:
        return None
    from mavwire.cli._output import writing

    # A link and a log that is followed end with Ctrl-C, after which there is to be what came.
    in_place = args.follow or not os.path.isfile(args.log)
    return stack.enter_context(writing(args.output, [args.log], in_place=in_place)).write


@contextmanager
def _profiled() -> Iterator[None]:
    import cProfile
    import pstats

    with cProfile.Profile() as profile:
        yield
    pstats.Stats(profile, stream=sys.stderr).sort_stats("cumulative").print_stats(40)


class Writer:
    """Standard output for UTF-8 lines: a file, a terminal, or a buffer of a test."""

    def __init__(self) -> None:
        self._file = sys.stdout
        self.to_terminal = is_terminal(sys.stdout)
        self._binary = getattr(sys.stdout, "buffer", None)
        encoding = (getattr(sys.stdout, "encoding", None) or "utf-8").lower()
        self._encoding = "" if encoding.replace("-", "") == "utf8" else encoding

    def write(self, lines: bytes) -> None:
        """Write all of it, as far as the reader takes it; a log does not steer a terminal."""
        if self.to_terminal:
            lines = shown_to(self._file, lines.decode()).encode()
        if self._binary is None:
            self._file.write(lines.decode())
            return
        if self._encoding:
            lines = lines.decode().encode(self._encoding, "backslashreplace")
        left = memoryview(lines)
        while left:  # an unbuffered file may take a part
            left = left[self._binary.write(left) or 0 :]

    def line(self, text: str) -> None:
        """Write one line."""
        self.write(text.encode("utf-8", "backslashreplace") + b"\n")

    def flush(self) -> None:
        """Let the reader see what was written."""
        self._file.flush()


def _dump(
    args: Namespace,
    log: Reading,
    writer: Writer,
    record: Callable[[bytes], Any] | None,
    tables: Tables | None,
) -> None:
    link = log.link
    shape = _dump_format.formatter(args, link)
    for problem in unknown_types(args, link):
        tell(f"mavwire dump: {problem}")
    selection = Selection(args, log)
    if isinstance(shape, _dump_format.Csv):
        writer.line(shape.header())
    log.by_index = selection.visited is not None
    if _dump_native.fits(args, link):
        _dump_native.dump(args, log, selection, shape, writer.write, record)
    else:
        sink = Sink(args, log, shape, writer, record, tables)
        _dump_messages(args, log, selection, sink)
    writer.flush()


def _dump_messages(args: Namespace, log: Reading, selection: Selection, sink: Sink) -> None:
    """The ordinary loop: one message after the other through all filters."""
    seen: dict[str, None] = {}
    for msg in log.messages(selection.visited, blocking=args.follow):
        kind = msg.get_type()
        seen[kind] = None
        if selection.thins_out(msg, kind):
            continue
        if selection.preserves(kind):
            sink.record(msg)
        elif selection.passes(msg, kind):
            sink.record(msg)
            sink.show(msg)
    sink.finish()
    if args.show_types:
        for kind in sorted(seen):
            sink.writer.line(kind)


class Sink:
    """Where messages go: lines to standard output or tables, records to a log of their own."""

    def __init__(
        self,
        args: Namespace,
        log: Reading,
        shape: Any,
        writer: Writer,
        record: Callable[[bytes], Any] | None,
        tables: Tables | None = None,
    ) -> None:
        self.writer = writer
        self._tables = tables
        self._log = log
        self._link = log.link
        self._shape = shape
        self._record = record
        self._stamped = hasattr(log.link, "mav")
        self._silent = args.quiet
        # Text is left out where only the types are asked for.
        self._shows = not (args.show_types and args.format == "standard")
        self._loss: int | None = 0 if args.show_loss else None
        self._prompt = args.follow or writer.to_terminal
        self._texts = StatusTexts() if args.format == "json" else None

    def record(self, msg: Any) -> None:
        """Append the message to the output file, if there is one."""
        if self._record is None:
            return
        frame = msg.get_msgbuf()
        if frame and self._stamped:
            self._record(record_of(msg._timestamp, frame))
        elif frame:
            self._record(frame)

    def show(self, msg: Any) -> None:
        """Print the message, and how many were lost since the one before."""
        if self._silent:
            return
        self._log.count_unknown(msg.get_type())
        if self._tables is not None:
            self._tables.add(msg)
            return
        if self._texts is not None and msg.get_type() == "STATUSTEXT" and self._stamped:
            self._show_texts(self._texts.hear(msg))
        elif self._shows:
            self.writer.line(self._shape.line(msg))
        if self._loss is not None and self._loss != self._link.mav_loss:
            self.writer.line(f"lost {self._link.mav_loss - self._loss} messages")
            self._loss = self._link.mav_loss
        if self._prompt:
            self.writer.flush()

    def finish(self) -> None:
        """Print the texts that have not come to their end."""
        if self._texts is not None and not self._silent:
            self._show_texts(self._texts.finish())

    def _show_texts(self, texts: list[tuple[Any, bytes]]) -> None:
        for first, text in texts:
            self.writer.line(self._shape.line(first, text))
