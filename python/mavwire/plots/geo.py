"""Tracks as KML 2.2 and GPX 1.1, line by line: a text of hours takes much more than the track."""

from __future__ import annotations

import re
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from html import escape

from .track import Place, Track

_FORBIDDEN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML does not have, not even escaped."""


def kml(track: Track) -> Iterator[str]:
    """A folder of lines, one for each stretch in a mode, and of places."""
    colour = track.colours()
    style = {mode: f"mode{number}" for number, mode in enumerate(colour)}
    yield '<?xml version="1.0" encoding="UTF-8"?>\n'
    yield '<kml xmlns="http://www.opengis.net/kml/2.2">\n'
    yield f"<Document>\n<name>{_text(track.name)}</name>\n"
    for mode, value in colour.items():
        yield _style(style[mode], _abgr(value), 3)
    yield _style("mission", "b0ffffff", 1)
    for mode, first, end in track.stretches():
        yield f"<Placemark>\n<name>{_text(mode or 'track')}</name>\n"
        begin, until = _time(track.times[first]), _time(track.times[end - 1])
        if begin and until:
            yield f"<TimeSpan><begin>{begin}</begin><end>{until}</end></TimeSpan>\n"
        yield f"<styleUrl>#{style[mode]}</styleUrl>\n"
        points = range(first, min(end + 1, len(track.times)))  # the next one begins where it ends
        way = (_point(track.lon[n], track.lat[n], track.alt[n]) for n in points)
        yield from _line_string(way, "absolute")
        yield "</Placemark>\n"
    if len(track.waypoints) > 1:
        way = (_point(place.lon, place.lat, 0.0) for place in track.waypoints)
        yield "<Placemark>\n<name>mission</name>\n<styleUrl>#mission</styleUrl>\n"
        yield from _line_string(way, "clampToGround")
        yield "</Placemark>\n"
    for place in [*([track.home] if track.home else []), *track.waypoints]:
        yield f"<Placemark><name>{_text(place.name)}</name>\n"
        yield f"<description>{place.alt:.2f} m</description>\n"
        coordinates = _point(place.lon, place.lat, 0.0)
        yield f"<Point><coordinates>{coordinates}</coordinates></Point>\n</Placemark>\n"
    yield "</Document>\n</kml>\n"


def gpx(track: Track) -> Iterator[str]:
    """Home as a way point, the mission as a route, the track with a segment for each stretch in a
    mode.
    """
    yield '<?xml version="1.0" encoding="UTF-8"?>\n'
    yield '<gpx version="1.1" creator="mavwire" xmlns="http://www.topografix.com/GPX/1/1">\n'
    yield f"<metadata><name>{_text(track.name)}</name></metadata>\n"
    if track.home is not None:
        yield _waypoint("wpt", track.home)
    if track.waypoints:
        yield "<rte>\n<name>mission</name>\n"
        yield from (_waypoint("rtept", place) for place in track.waypoints)
        yield "</rte>\n"
    yield f"<trk>\n<name>{_text(track.name)}</name>\n"
    for _, first, end in track.stretches():
        yield "<trkseg>\n"
        for n in range(first, end):
            time = _time(track.times[n])
            stamp = f"<time>{time}</time>" if time else ""
            yield (
                f'<trkpt lat="{track.lat[n]:.7f}" lon="{track.lon[n]:.7f}">'
                f"<ele>{track.alt[n]:.3f}</ele>{stamp}</trkpt>\n"
            )
        yield "</trkseg>\n"
    yield "</trk>\n</gpx>\n"


def _text(text: str) -> str:
    """A text for XML. Characters that XML does not have become U+FFFD."""
    return escape(_FORBIDDEN.sub("\ufffd", text))


def _time(seconds: float) -> str | None:
    """A time of XML Schema; None beyond the years that it has, and for what is no number."""
    try:
        time = datetime(1970, 1, 1, tzinfo=UTC) + timedelta(seconds=float(seconds))
    except (OverflowError, ValueError):
        return None
    return time.isoformat(timespec="milliseconds").replace("+00:00", "Z")


def _point(lon: float, lat: float, alt: float) -> str:
    return f"{lon:.7f},{lat:.7f},{alt:.2f}"


def _style(name: str, colour: str, width: int) -> str:
    line = f"<LineStyle><color>{colour}</color><width>{width}</width></LineStyle>"
    return f'<Style id="{name}">{line}</Style>\n'


def _line_string(points: Iterator[str], mode: str) -> Iterator[str]:
    yield f"<LineString><altitudeMode>{mode}</altitudeMode><coordinates>"
    yield next(points, "")
    yield from (f" {point}" for point in points)
    yield "</coordinates></LineString>\n"


def _waypoint(element: str, place: Place) -> str:
    return (
        f'<{element} lat="{place.lat:.7f}" lon="{place.lon:.7f}"><ele>{place.alt:.3f}</ele>'
        f"<name>{_text(place.name)}</name></{element}>\n"
    )


def _abgr(colour: str) -> str:
    """`#rrggbb` as KML writes it, opaque."""
    return f"ff{colour[5:7]}{colour[3:5]}{colour[1:3]}"
