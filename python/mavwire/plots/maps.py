"""`draw_map`: the way of a vehicle as a page, as KML or as GPX."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from typing import Any

from mavwire._extras import extra
from mavwire._text import cannot_write
from mavwire.dialects import UPSTREAM
from mavwire.logs.store import write_file
from mavwire.logs.targets import file_to_write

from .geo import gpx, kml
from .pages import MOST_POINTS, packed, page
from .track import Place, Track, read_track


def draw_map(
    log: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    system: int | None = None,
    dialect: str | os.PathLike[str] = UPSTREAM,
) -> Track:
    """Draw where a vehicle was, coloured by flight mode, with its home and its mission.

    `out` ends in .html, .kml or .gpx. `system` is the vehicle's id, by default the first autopilot
    that is heard. Returns the track. Raises OSError for files that cannot be read or written,
    ValueError for a log without positions.
    """
    with extra("plot"):
        import numpy  # noqa: F401
    out = os.fspath(out)
    writers: dict[str, Callable[[Track], bytes | Iterator[str]]]
    writers = {".html": map_page, ".htm": map_page, ".kml": kml, ".gpx": gpx}
    writer = writers.get(os.path.splitext(out)[1].lower())
    if writer is None:
        raise ValueError(cannot_write(out, [*writers]))
    target = file_to_write(out)
    track = read_track(os.fspath(log), system=system, dialect=dialect)
    write_file(target, writer(track))
    return track


def map_page(track: Track) -> bytes:
    """A page with the track on a grid of latitude and longitude."""
    import numpy as np

    step = -(-len(track.times) // MOST_POINTS)
    kept = np.unique(np.append(np.arange(0, len(track.times), step), len(track.times) - 1))
    thin = Track(track.path, *(a[kept] for a in (track.times, track.lat, track.lon, track.alt)))
    thin.modes = track.modes
    longitudes = np.unwrap(thin.lon, period=360)  # a way over the date line goes on
    colour = track.colours()
    data: dict[str, Any] = {
        "t": packed(thin.times),
        "lat": packed(thin.lat),
        "lon": packed(longitudes),
        "alt": packed(thin.alt),
        "stretches": [
            {"mode": mode, "colour": colour[mode], "first": first, "end": end}
            for mode, first, end in thin.stretches()
        ],
        "home": None if track.home is None else _near(track.home, longitudes),
        "waypoints": [_near(place, longitudes) for place in track.waypoints],
    }
    help = "wheel: zoom · drag: move · double click: all"
    return page(track.name, help, data, "map.js")


def _near(place: Place, longitudes: Any) -> dict[str, Any]:
    """A place, on the side of the date line that the track is on."""
    turns = round((float(longitudes[0]) - place.lon) / 360)
    return {"name": place.name, "lat": place.lat, "lon": place.lon + 360 * turns, "alt": place.alt}
