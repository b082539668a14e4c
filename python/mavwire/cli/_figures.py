"""Figures of commands, with errors that say what is missing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavwire.cli._errors import refused

if TYPE_CHECKING:
    from mavwire.plots.windows import Figures


def open_figures(output: str | None, option: str = "--image") -> Figures:
    """Figures for windows, or for the image `output` of an option; CommandError if there can be none."""
    from mavwire.plots.windows import Figures

    with refused(ImportError, ValueError):
        return Figures(output, option)
