"""Compass calibration by the field of the Earth at the place of the flight (magfit_WMM.py).

Fits offsets, scale and, if wanted, elliptical and motor corrections of one compass in a dataflash
log. The expected field is that of the world magnetic model, turned by the attitude.
"""

from __future__ import annotations

import os
from argparse import ArgumentParser, Namespace
from math import atan2, degrees, radians
from typing import TYPE_CHECKING, Any

from mavwire._log_link import kind_of
from mavwire.cli._errors import CommandError, refused
from mavwire.cli._output import open_figures, writing
from mavwire.cli._reading import Reading, definitions, reading
from mavwire.cli._shared_arguments import add_shared

if TYPE_CHECKING:
    from mavwire.cli.vehicle._field_fit import Correction

# AHRS_EKF_TYPE -> where the attitude is.
SOURCES = {2: "NKF1", 3: "XKF1"}
CURRENT, THROTTLE = 2, 1
FIX_3D = 3


def add_arguments(parser: ArgumentParser) -> None:
    add = parser.add_argument
    add("log", metavar="LOG", help="dataflash log")
    add_shared(parser, "condition")
    add("--mag", type=int, default=1, choices=(1, 2, 3), help="which compass (default: 1)")
    add("--reduce", type=int, default=1, help="take every so many measurements")
    for name, least, most in (("scale", 0.6, 1.5), ("diag", 0.8, 1.2), ("offdiag", -0.2, 0.2)):
        add(f"--min-{name}", type=float, default=least, help="default: %(default)s")
        add(f"--max-{name}", type=float, default=most, help="default: %(default)s")
    add("--max-offset", type=float, default=1500.0, help="default: %(default)s")
    add("--max-cmot", type=float, default=10.0, help="largest motor correction")
    add("--no-offset-change", action="store_true", help="keep the offsets")
    add("--no-cmot-change", action="store_true", help="keep the motor correction")
    add("--elliptical", action="store_true", help="fit diagonals and off-diagonals")
    add("--cmot", action="store_true", help="fit the motor correction by the current")
    add("--cmot-throttle", action="store_true", help="fit the motor correction by the throttle")
    add("--lat", type=float, default=0.0, help="latitude, where GPS does not tell it")
    add("--lon", type=float, default=0.0, help="longitude")
    add("--att-source", help="message with the attitude (default: by AHRS_EKF_TYPE)")
    add("--save-plot", action="store_true", help="save a picture beside the log")
    add("--save-params", action="store_true", help="save the parameters beside the log")
    add("--iter", type=int, default=100, help="most rounds of the fit")


def main(args: Namespace) -> int:
    try:
        import numpy as np
    except ImportError as error:
        raise CommandError("NumPy is needed to fit: pip install 'mavwire[tools]'") from error
    from mavwire.cli.vehicle._field_fit import fit

    _check(args)
    figures = open_figures(f"{_stem(args)}.png") if args.save_plot else None
    print(f"Processing log {args.log}")
    with definitions(), reading("magfit_WMM", args.log) as log:
        kind = kind_of(log.link)
        if kind != "dataflash":
            raise CommandError(f"{args.log} is a {kind} log; this is for dataflash logs only")
        samples = Samples(log, args)
    raw, expected, load = (np.array(one, float) for one in samples.arrays())
    print(f"Extracted {len(raw)} points")
    current = samples.current()
    print(f"Current: {_line(current, samples.mode)}")
    found = fit(raw.reshape(-1, 3), expected.reshape(-1, 3), load, current, _limits(args))
    mode = _mode(args) or (samples.mode if args.no_cmot_change else 0)
    print(f"New: {_line(found, mode)}")
    for name, one in (("before", current), ("after", found)):
        away = np.linalg.norm(one.apply(raw, load) - expected, axis=1)
        print(f"Mean distance from the expected field {name}: {away.mean():.1f}")
    if args.save_params:
        _save(args, found, mode)
    if figures is not None:
        _draw(figures.figure(args.log), expected, found.apply(raw, load))
        figures.finish()
    return 0


def _check(args: Namespace) -> None:
    """CommandError for numbers that mean nothing."""
    if args.reduce < 1:
        raise CommandError("--reduce is a number of measurements, at least 1")
    for name in ("scale", "diag", "offdiag"):
        if not getattr(args, f"min_{name}") <= getattr(args, f"max_{name}"):
            raise CommandError(f"--min-{name} is above --max-{name}, or one of them is no number")


def _stem(args: Namespace) -> str:
    return f"{os.path.splitext(args.log)[0]}-magfit-mag-{args.mag}"


def _mode(args: Namespace) -> int:
    """COMPASS_MOTCT: what a motor correction goes by, 0 if none is fitted."""
    if args.no_cmot_change:
        return 0
    return CURRENT if args.cmot else THROTTLE if args.cmot_throttle else 0


def _limits(args: Namespace) -> Any:
    from mavwire.cli.vehicle._field_fit import Limits

    return Limits(
        (args.min_scale, args.max_scale), args.max_offset, (args.min_diag, args.max_diag),
        (args.min_offdiag, args.max_offdiag), args.max_cmot, args.elliptical,
        bool(_mode(args)), not args.no_offset_change, args.iter,
    )  # fmt: skip


class Samples:
    """The measurements of the compass without any correction, and the expected ones."""

    def __init__(self, log: Reading, args: Namespace) -> None:
        self._log, self._args = log, args
        self._params: dict[str, float] = log.link.params
        self._rows: list[tuple[tuple[float, ...], tuple[float, ...], float]] = []
        self.mode = int(self._parameter("MOTCT"))
        self._by = _mode(args) or (self.mode if args.no_cmot_change else 0)
        self._read(self._source(), self._field())

    def arrays(self) -> tuple[list[Any], list[Any], list[float]]:
        """Raw fields, expected fields and loads."""
        return tuple(list(one) for one in zip(*self._rows, strict=True)) or ([], [], [])  # type: ignore[return-value]

    def _parameter(self, name: str, default: float = 0.0) -> float:
        """A parameter of this compass: the second one has COMPASS_OFS2_X."""
        kind, _, axis = name.partition("_")
        number = "" if self._args.mag == 1 or kind == "MOTCT" else str(self._args.mag)
        full = f"COMPASS_{kind}{number}" + (f"_{axis}" if axis else "")
        return float(self._params.get(full, default))

    def current(self) -> Correction:
        """The correction that the vehicle flew with."""
        import numpy as np

        from mavwire.cli.vehicle._field_fit import Correction

        def triple(kind: str, default: float = 0.0) -> Any:
            return np.array([self._parameter(f"{kind}_{axis}", default) for axis in "XYZ"])

        motor = triple("MOT") if self._by == self.mode else np.zeros(3)
        scale = self._parameter("SCALE") or 1.0
        return Correction(triple("OFS"), triple("DIA", 1.0), triple("ODI"), motor, scale)

    def _source(self) -> str:
        """The type of the messages with the attitude."""
        if self._args.att_source:
            if not self._has(self._args.att_source):
                raise CommandError(f"--att-source: there is no {self._args.att_source} in the log")
            return str(self._args.att_source)
        source = SOURCES.get(int(self._params.get("AHRS_EKF_TYPE", 0)), "ATT")
        if not self._has(source):
            source = "ATT"
        print(f"Attitude source {source}")
        return source

    def _has(self, kind: str) -> bool:
        """Whether there are messages of a type. Text logs are counted by name, binary ones by id."""
        link = self._log.link
        if kind not in link.name_to_id:
            return False
        by_name = isinstance(link.counts, dict)
        return bool(link.counts.get(kind) if by_name else link.counts[link.name_to_id[kind]])

    def _field(self) -> Any:
        """The field of the Earth: north, east, down, in milligauss."""
        from mavwire.mavextra import expected_earth_field_lat_lon

        lat, lon = self._args.lat, self._args.lon
        if not lat and not lon:
            lat, lon = self._place()
        with refused(ValueError):
            field = expected_earth_field_lat_lon(lat, lon)
        print(
            f"Earth field: {field!r}  strength {field.length():.0f}"
            f" declination {degrees(atan2(field.y, field.x)):.1f} degrees"
        )
        return field

    def _place(self) -> tuple[float, float]:
        for msg in self._log.messages(["GPS"]):
            if msg.Status >= FIX_3D:
                self._log.link.rewind()
                return msg.Lat, msg.Lng
        raise CommandError("no position in the log: give --lat and --lon")

    def _read(self, source: str, field: Any) -> None:
        from mavwire.rotmat import Matrix3

        trim = Matrix3()
        trim.from_euler(*(float(self._params.get(f"AHRS_TRIM_{axis}", 0.0)) for axis in "XYZ"))
        old_name = f"MAG{self._args.mag}" if self._args.mag > 1 else "MAG"
        types = ["MAG", old_name, source, "BAT", "CTUN"]
        attitude: Matrix3 | None = None
        load, count = 0.0, 0
        for msg in self._log.messages(types, self._args.condition):
            kind = msg.get_type()
            if kind == source and getattr(msg, "C", 0) == 0:
                vehicle = Matrix3()
                vehicle.from_euler(radians(msg.Roll), radians(msg.Pitch), radians(msg.Yaw))
                attitude = vehicle * trim
            elif kind == "BAT" and self._by == CURRENT and getattr(msg, "Inst", 0) == 0:
                load = msg.Curr
            elif kind == "CTUN" and self._by == THROTTLE:
                load = msg.ThO
            elif kind in ("MAG", old_name) and self._is_ours(msg) and attitude is not None:
                count += 1
                if count % self._args.reduce == 0:
                    wanted = attitude.transposed() * field
                    self._rows.append((_raw(msg), (wanted.x, wanted.y, wanted.z), load))

    def _is_ours(self, msg: Any) -> bool:
        """Whether it is this compass that measured."""
        number = getattr(msg, "I", None)
        if number is None:
            return bool(
                msg.get_type() == ("MAG" if self._args.mag == 1 else f"MAG{self._args.mag}")
            )
        return bool(number == self._args.mag - 1)


def _raw(msg: Any) -> tuple[float, ...]:
    """A measurement without offsets and motor correction."""
    return tuple(
        getattr(msg, f"Mag{axis}") - getattr(msg, f"Ofs{axis}") - getattr(msg, f"MO{axis}", 0.0)
        for axis in "XYZ"
    )


def _line(one: Correction, mode: int) -> str:
    from mavwire.rotmat import Vector3

    offsets, diagonals, offdiagonals, motor = (
        repr(Vector3(*map(float, values)))
        for values in (one.offsets, one.diagonals, one.offdiagonals, one.motor)
    )
    return (
        f"{offsets} diag: {diagonals} offdiag: {offdiagonals}"
        f" cmot_mode: {mode} cmot: {motor} scale: {one.scale:.2f}"
    )


def _save(args: Namespace, found: Correction, mode: int) -> None:
    number = "" if args.mag == 1 else str(args.mag)
    kinds = (
        ("OFS", "%d", found.offsets), ("DIA", "%.3f", found.diagonals),
        ("ODI", "%.3f", found.offdiagonals), ("MOT", "%.3f", found.motor),
    )  # fmt: skip
    lines = [
        f"COMPASS_{kind}{number}_{axis} {form % value}"
        for kind, form, values in kinds
        for axis, value in zip("XYZ", values, strict=True)
    ]
    lines += [f"COMPASS_SCALE{number} {found.scale:.2f}", f"COMPASS_MOTCT {mode}"]
    name = f"{_stem(args)}.param"
    print(f"Saving params to {name}")
    with writing(name, [args.log], "--save-params") as file:
        file.write("".join(f"{line}\n" for line in lines).encode())


def _draw(figure: Any, expected: Any, corrected: Any) -> None:
    """The three axes, as expected and as corrected."""
    for number, axis in enumerate("XYZ"):
        axes = figure.add_subplot(3, 1, number + 1)
        axes.plot(expected[:, number], label=f"expected {axis}")
        axes.plot(corrected[:, number], label=f"corrected {axis}")
        axes.legend(loc="upper right")
