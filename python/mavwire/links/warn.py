"""Warnings of links, which go to the logger `mavwire.mavutil`."""

from __future__ import annotations


def warn(text: str, *arguments: object) -> None:
    """Log a warning. `logging` loads with the first one."""
    import logging

    logging.getLogger("mavwire.mavutil").warning(text, *arguments)
