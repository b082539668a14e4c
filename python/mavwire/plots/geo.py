"""Tracks as KML 2.2 and GPX 1.1."""

from __future__ import annotations

import re
from datetime import UTC, datetime, timedelta
from html import escape
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .track import Place, Track

_FORBIDDEN = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML does not have, not even escaped."""


def kml(track: Track) -> bytes:
    """A folder of lines, one for each stretch in a mode, and of places."""
    colour = track.colours()
    style = {mode: f"mode{number}" for number, mode in enumerate(colour)}
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<kml xmlns="http://www.opengis.net/kml/2.2">',
        "<Document>",
        f"<name>{_text(track.name)}</name>",
    ]
    for mode, value in colour.items():
        lines.append(
            f'<Style id="{style[mode]}"><LineStyle><color>{_abgr(value)}</color><width>3</width>'
            "</LineStyle></Style>"
        )
    lines.append(
        '<Style id="mission"><LineStyle><color>b0ffffff</color><width>1</width></LineStyle></Style>'
    )
    for mode, first, end in track.stretches():
        lines += ["<Placemark>", f"<name>{_text(mode or 'track')}</name>"]
        begin, until = _time(track.times[first]), _time(track.times[end - 1])
        if begin and until:
            lines.append(f"<TimeSpan><begin>{begin}</begin><end>{until}</end></TimeSpan>")
        points = range(first, min(end + 1, len(track.times)))  # the next one begins where it ends
        way = " ".join(_point(track.lon[n], track.lat[n], track.alt[n]) for n in points)
        lines += [f"<styleUrl>#{style[mode]}</styleUrl>", _line_string(way, "absolute")]
        lines.append("</Placemark>")
    if len(track.waypoints) > 1:
        way = " ".join(_point(place.lon, place.lat, 0.0) for place in track.waypoints)
        lines += ["<Placemark>", "<name>mission</name>", "<styleUrl>#mission</styleUrl>"]
        lines += [_line_string(way, "clampToGround"), "</Placemark>"]
    for place in [*([track.home] if track.home else []), *track.waypoints]:
        lines += [
            f"<Placemark><name>{_text(place.name)}</name>",
            f"<description>{place.alt:.2f} m</description>",
            f"<Point><coordinates>{_point(place.lon, place.lat, 0.0)}</coordinates></Point>",
            "</Placemark>",
        ]
    lines += ["</Document>", "</kml>", ""]
    return "\n".join(lines).encode()


def gpx(track: Track) -> bytes:
    """Home as a way point, the mission as a route, the track with a segment for each stretch in a
    mode.
    """
    lines = [
        '<?xml version="1.0" encoding="UTF-8"?>',
        '<gpx version="1.1" creator="mavwire" xmlns="http://www.topografix.com/GPX/1/1">',
        f"<metadata><name>{_text(track.name)}</name></metadata>",
    ]
    if track.home is not None:
        lines.append(_waypoint("wpt", track.home))
    if track.waypoints:
        lines += ["<rte>", "<name>mission</name>"]
        lines += [_waypoint("rtept", place) for place in track.waypoints]
        lines.append("</rte>")
    lines += ["<trk>", f"<name>{_text(track.name)}</name>"]
    for _, first, end in track.stretches():
        lines.append("<trkseg>")
        for n in range(first, end):
            time = _time(track.times[n])
            stamp = f"<time>{time}</time>" if time else ""
            lines.append(
                f'<trkpt lat="{track.lat[n]:.7f}" lon="{track.lon[n]:.7f}">'
                f"<ele>{track.alt[n]:.3f}</ele>{stamp}</trkpt>"
            )
        lines.append("</trkseg>")
    lines += ["</trk>", "</gpx>", ""]
    return "\n".join(lines).encode()


def _text(text: str) -> str:
    """A text for XML. What it does not have becomes U+FFFD."""
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


def _line_string(way: str, mode: str) -> str:
    return (
        f"<LineString><altitudeMode>{mode}</altitudeMode>"
        f"<coordinates>{way}</coordinates></LineString>"
    )


def _waypoint(element: str, place: Place) -> str:
    return (
        f'<{element} lat="{place.lat:.7f}" lon="{place.lon:.7f}"><ele>{place.alt:.3f}</ele>'
        f"<name>{_text(place.name)}</name></{element}>"
    )


def _abgr(colour: str) -> str:
    """`#rrggbb` as KML writes it, opaque."""
    return f"ff{colour[5:7]}{colour[3:5]}{colour[1:3]}"
