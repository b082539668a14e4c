"""Compass offsets by the sphere that the measurements lie on (magfit.py)."""

from __future__ import annotations

from argparse import ArgumentParser, Namespace
from typing import Any

from mavwire._log_link import kind_of
from mavwire.cli._errors import CommandError, tell
from mavwire.cli._output import open_figures
from mavwire.cli._reading import Reading, results
from mavwire.cli._shared_arguments import add_shared

PARAMETERS = ("COMPASS_OFS_X", "COMPASS_OFS_Y", "COMPASS_OFS_Z")
# A sphere has four numbers; fewer points than this say little about it.
LEAST = 20
# Measurements further from the sphere than this many standard deviations are left out, twice; a
# deviation is so many times the median distance where noise is normal.
OUTLIER = 4.0
DEVIATIONS = 1.4826
# So are those this many times as far from the middle as half of them.
FAR = 10.0
ROUNDS = 3
# A mean distance from the sphere beyond this share of its radius is no calibration.
WORST = 0.15

Offsets = tuple[float, ...]
Points = list[tuple[float, ...]]


def add_arguments(parser: ArgumentParser) -> None:
    add_shared(parser, "logs", "no_timestamps", "condition")
    add = parser.add_argument
    add("--noise", type=float, default=0.0, help="noise to add, to see how good the fit is")
    add("--mag2", action="store_true", help="the second compass of a dataflash log, not the first")
    add("--radius", type=float, help="strength of the field, where it is known")
    add("--plot", action="store_true", help="show the points in 3D")
    add("--image", metavar="FILE", help="with --plot: an image, and no window")


def main(args: Namespace) -> int:
    try:
        import numpy as np
    except ImportError as error:
        raise CommandError("NumPy is needed to fit: pip install 'mavwire[tools]'") from error
    if not 0 <= args.noise < float("inf"):
        raise CommandError(f"--noise is a number of milligauss, not {args.noise}")
    if args.radius is not None and not 0 < args.radius < float("inf"):
        raise CommandError(f"--radius is a number of milligauss, not {args.radius}")
    figures = open_figures(args.image) if args.plot else None
    for path, points, offsets in results("magfit", args, lambda log: _read(log, args)):
        print(f"Extracted {len(points)} data points")
        print(f"Current offsets: {_vector(offsets)}")
        raw = np.array(points, float).reshape(-1, 3)
        if args.noise:
            raw = raw + np.random.default_rng().uniform(-args.noise, args.noise, raw.shape)
        centre, radius, kept = fit(raw, args.radius)
        residual = _distances(raw[kept], centre) - radius
        print(f"Fitted {int(kept.sum())} data points")
        print(f"New offsets: {_vector(-centre)}")
        print(f"Field strength: {radius:.1f}, residual {residual.std():.2f}")
        _warn_of_no_sphere(path, float(np.sqrt((residual**2).mean())), radius)
        if figures is not None:
            draw(figures.figure(path), raw, centre)
    if figures is not None:
        figures.finish()
    return 0


def _warn_of_no_sphere(path: str, residual: float, radius: float) -> None:
    if residual > WORST * radius:
        tell(
            f"mavwire magfit: {path}: the measurements do not lie on a sphere; do not use these offsets"
        )


def _vector(values: Any) -> str:
    from mavwire.rotmat import Vector3

    return repr(Vector3(*(float(one) for one in values)))


def _read(log: Reading, args: Namespace) -> tuple[str, Points, Offsets]:
    """The log, the field that one compass measured, without offsets, and the offsets that it had last."""
    kind = kind_of(log.link)
    if kind == "CSV":
        raise CommandError(f"{log.path} is a CSV log; this is for telemetry and dataflash logs")
    if kind == "telemetry":
        return log.path, *_telemetry(log, args.condition)
    return log.path, *_dataflash(log, args.mag2, args.condition)


def _telemetry(log: Reading, condition: str | None) -> tuple[Points, Offsets]:
    points: Points = []
    offsets = [0.0, 0.0, 0.0]
    for msg in log.messages(("RAW_IMU", "SENSOR_OFFSETS", "PARAM_VALUE"), condition):
        kind = msg.get_type()
        if kind == "SENSOR_OFFSETS":
            offsets = [float(getattr(msg, f"mag_ofs_{axis}")) for axis in "xyz"]
        elif kind == "PARAM_VALUE":
            if msg.param_id in PARAMETERS:
                offsets[PARAMETERS.index(msg.param_id)] = msg.param_value
        else:
            field = (msg.xmag, msg.ymag, msg.zmag)
            points.append(tuple(one - ofs for one, ofs in zip(field, offsets, strict=True)))
    return points, tuple(offsets)


def _dataflash(log: Reading, second: bool, condition: str | None) -> tuple[Points, Offsets]:
    """Old logs have a type for each compass, newer ones an instance field in MAG."""
    kind = "MAG2" if second and "MAG2" in log.link.name_to_id else "MAG"
    wanted = 1 if second and kind == "MAG" else 0
    points: Points = []
    offsets: Offsets = (0.0, 0.0, 0.0)
    for msg in log.messages([kind], condition):
        if getattr(msg, msg.fmt.instance_field or "I", 0) != wanted:
            continue
        offsets = tuple(getattr(msg, f"Ofs{axis}") for axis in "XYZ")
        field = (getattr(msg, f"Mag{axis}") for axis in "XYZ")
        points.append(tuple(one - ofs for one, ofs in zip(field, offsets, strict=True)))
    return points, offsets


def fit(points: Any, radius: float | None = None) -> tuple[Any, float, Any]:
    """The sphere on which points (an array of n by 3) lie: its centre, its radius, and which of the
    points count: those that are not far from it. CommandError if they make no sphere.
    """
    import numpy as np

    kept = np.isfinite(points).all(axis=1)
    if kept.any():  # what is far beyond all others would bend the first fit
        far = _distances(points, np.median(points[kept], axis=0))
        kept &= far <= FAR * np.median(far[kept])
    centre, size = _fit(points[kept], radius)
    for _ in range(ROUNDS - 1):
        distances = np.abs(_distances(points, centre) - size)
        spread = float(np.median(distances[kept])) * DEVIATIONS
        near = kept & (distances <= max(OUTLIER * spread, 1e-6 * size))
        if near.sum() < LEAST:
            break
        kept = near
        centre, size = _fit(points[kept], radius)
    return centre, size, kept


def _fit(points: Any, radius: float | None) -> tuple[Any, float]:
    import numpy as np

    if len(points) < LEAST:
        raise CommandError(f"{len(points)} data points are too few to fit a sphere: {LEAST} needed")
    # |p|^2 = 2 c.p + (r^2 - |c|^2) is linear in what is unknown.
    middle = points.mean(axis=0)
    centred = points - middle
    system = np.column_stack((2.0 * centred, np.ones(len(points))))
    found, _, rank, _ = np.linalg.lstsq(system, (centred**2).sum(axis=1), rcond=1e-10)
    size = float(found[3] + found[:3] @ found[:3])
    if rank < 4 or size <= 0:
        raise CommandError("the data points make no sphere: turn the vehicle about all axes")
    if radius is None:
        return found[:3] + middle, float(np.sqrt(size))
    return _fit_centre(points, found[:3] + middle, radius), radius


def _fit_centre(points: Any, centre: Any, radius: float) -> Any:
    """The centre of a sphere of known size, by Gauss and Newton's method."""
    import numpy as np

    for _ in range(50):
        away = points - centre
        distances = np.maximum(np.linalg.norm(away, axis=1), 1e-9)
        step = np.linalg.lstsq(-away / distances[:, None], radius - distances, rcond=None)[0]
        centre = centre + step
        if np.linalg.norm(step) < 1e-9 * radius:
            break
    return centre


def _distances(points: Any, centre: Any) -> Any:
    import numpy as np

    return np.linalg.norm(points - centre, axis=1)


def draw(figure: Any, points: Any, centre: Any) -> None:
    """The points as measured and with the new offsets."""
    axes = figure.add_subplot(projection="3d")
    for name, values in (("measured", points), ("corrected", points - centre)):
        axes.scatter(*values.T, s=4, label=name)
    axes.legend(loc="upper right")
