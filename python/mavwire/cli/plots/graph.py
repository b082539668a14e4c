"""Fields and formulas over time, or over another one, in a window or an image (mavgraph.py).

An expression with :2 behind it has the axis on the right. A formula over several messages has a
value at each of them, with the newest of the others.
"""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from array import array
from collections.abc import Mapping
from typing import Any

from mavwire._text import in_words
from mavwire.cli._errors import CommandError, refused, tell
from mavwire.cli._output import open_figures, refuse_log
from mavwire.cli._reading import definitions, link_options, reading
from mavwire.cli._shared_arguments import add_shared
from mavwire.cli.plots.plot import is_log
from mavwire.expression import evaluate_expression
from mavwire.plots.expressions import STATE_NAMES, Expression, as_number, parse, why_nothing
from mavwire.plots.graphs import SIZE, Graph, Style, check, draw
from mavwire.plots.series import is_instance

VEHICLES = ("ardupilot", "px4", "apm")


def add_arguments(parser: ArgumentParser) -> None:
    parser.add_argument(
        "what", metavar="LOG or EXPR", nargs="+", help="logs, and what to draw of them"
    )
    add_shared(parser, "no_timestamps", "planner", "condition")
    add = parser.add_argument
    add("--labels", help="names for the legend, separated by commas")
    add("--legend", default="upper left", help="where the legend is (default: %(default)s)")
    add("--legend2", default="upper right", help="that of the right axis (default: %(default)s)")
    add("--marker", help="of matplotlib, such as + (default: none; + with --xaxis)")
    add("--linestyle", help="of matplotlib (default: solid; none with --xaxis)")
    add("--xaxis", metavar="EXPR", help="what to draw over, in place of time")
    add("--multi", action="store_true", help="the same colours for each log")
    add("--zero-time-base", action="store_true", help="dataflash logs begin at time 0")
    add("--flightmode", metavar="apm|px4", help="shade flight modes")
    add_shared(parser, "dialect")
    add("--output", metavar="FILE", help="an image, such as .png, .svg or .pdf, and no window")
    add("--timeshift", type=float, default=0.0, help="seconds that the first log is moved by")


def main(args: Namespace) -> int:
    logs = [one for one in args.what if is_log(one)]
    fields = [one for one in args.what if not is_log(one)]
    _check(args, logs, fields)
    refuse_log(args.output or "", logs)
    figures = open_figures(args.output, "--output")
    graph = Graph(_style(args))
    expressions = [_parsed(one) for one in fields]
    x = None if args.xaxis is None else _parsed(args.xaxis)
    for number, path in enumerate(logs):
        print(f"Processing {path}")
        series = [Series(one, x) for one in expressions]
        _read(path, args, series, graph, args.timeshift if number == 0 else 0.0)
        names = args.labels.split(",") if args.labels else fields * len(logs)
        for place, one in enumerate(series, number * len(fields)):
            colour = place - number * len(fields) if args.multi else place
            one.draw(graph, names[place], fields[place - number * len(fields)], colour)
    if fields and not graph.lines:  # which was said
        return 1
    draw(figures.figure("", figsize=SIZE), graph)
    figures.finish()
    return 0


def _check(args: Namespace, logs: list[str], fields: list[str]) -> None:
    """CommandError for options that do not go together."""
    if not logs:
        raise CommandError("No files to process")
    if not fields and args.flightmode is None:
        reason = "no expression given: name a field, such as ATTITUDE.roll, or --flightmode"
        raise CommandError(reason)
    if args.labels is not None and len(args.labels.split(",")) != len(fields) * len(logs):
        count, wanted = len(args.labels.split(",")), len(fields) * len(logs)
        raise CommandError(f"Number of labels ({count}) must match number of fields ({wanted})")
    if args.flightmode is not None and args.xaxis:
        raise CommandError("Cannot request flightmode backgrounds with an x-axis expression")
    if args.flightmode is not None and args.flightmode not in VEHICLES:
        raise CommandError(
            f"Unknown flight controller '{args.flightmode}' in specification of --flightmode"
            f" (choose from {','.join(VEHICLES)})"
        )


def _style(args: Namespace) -> Style:
    style = Style(args.legend, args.legend2, args.marker, args.linestyle, args.xaxis is not None)
    try:
        check(style)
    except ValueError as error:
        raise CommandError(f"--legend, --legend2, --marker or --linestyle: {error}") from error
    return style


def _parsed(text: str) -> Expression:
    with refused(ValueError):
        return parse(text)


def _read(path: str, args: Namespace, series: list[Series], graph: Graph, shift: float) -> None:
    """Gather the values of one log."""
    types = None if args.flightmode else {kind for one in series for kind in one.types}
    with definitions(args.dialect), reading("graph", path, **link_options(args)) as log:
        modes = graph.modes(args.flightmode) if args.flightmode else None
        newest = Newest(log.link.messages)
        for msg in log.messages(types, args.condition):
            stamp = msg._timestamp + shift
            if modes is not None:
                modes.add(stamp, log.link.flightmode)
            kind = msg.get_type()
            newest[kind] = msg
            for one in series:
                if kind in one.types:
                    one.take(newest, msg, kind, stamp)
        if args.condition is None:  # which would be why
            for one in series:
                one.tell_why_nothing(newest)


class Newest(dict[str, Any]):
    """The newest messages of every sender by type, as mavgraph.py has them: the `messages` of a link
    are those of one vehicle, and hold some that did not come yet. Its state is there too.
    """

    def __init__(self, state: Mapping[str, Any]) -> None:
        self._state = state

    def __missing__(self, name: str) -> Any:
        if name in STATE_NAMES:
            return self._state[name]
        raise KeyError(name)


class Series:
    """The values of one expression over one log."""

    def __init__(self, expression: Expression, x: Expression | None) -> None:
        self.types = expression.types
        self._expression = expression
        self._over = None if x is None else x.text
        self._x: list[float] = []
        self._y: list[float | list[float]] = []
        self._texts: list[tuple[float, str]] = []

    def take(self, messages: Mapping[str, Any], msg: Any, kind: str, stamp: float) -> None:
        """A message came that the expression names; `messages` are the newest ones."""
        instance = self._expression.instances.get(kind)
        if instance is not None and not is_instance(msg, instance):
            return
        value = self._value(self._expression.text, messages)
        x = stamp if self._over is None else self._value(self._over, messages)
        if value is None or x is None:
            return
        if isinstance(value, str):
            self._texts.append((x, value))
            return
        try:
            y = _numbers(value)
            self._x.append(as_number(x))
        except ValueError as error:
            raise CommandError(f"{self._expression.text!r}: {error}") from error
        if self._y and _width(y) != _width(self._y[0]):
            raise CommandError(f"{self._expression.text!r}: arrays of different lengths")
        self._y.append(y)

    def _value(self, text: str, messages: Mapping[str, Any]) -> Any:
        try:
            return evaluate_expression(text, messages)
        except Exception as error:  # functions of expressions raise errors of any type
            raise CommandError(f"{text!r}: {in_words(error)}") from error

    def tell_why_nothing(self, messages: Mapping[str, Any]) -> None:
        """Say on standard error why there are no values, by the newest messages of the log."""
        if self._x or self._texts:
            return
        why = why_nothing(self._expression.text, messages)
        if why is None and self._over is not None:
            why = why_nothing(self._over, messages)
        if why:
            tell(f"mavwire graph: {self._expression.text}: {why}")

    def draw(self, graph: Graph, label: str, field: str, colour: int) -> None:
        """Add what was gathered to the graph; say so if that is nothing."""
        if not self._x and not self._texts:
            print(f"Failed to find any values for field {field}")
            return
        right = self._expression.right
        name = label.removesuffix(":2") if label == field else label
        graph.add(name, right, colour, self._x, self._y, self._texts)


def _numbers(value: Any) -> float | list[float]:
    """A number, or those of an array, of which each element is a line."""
    if isinstance(value, list | tuple | array):
        return [as_number(one) for one in value]
    return as_number(value)


def _width(y: float | list[float]) -> int | None:
    """How many lines it belongs to; None for that of a number."""
    return len(y) if isinstance(y, list) else None
