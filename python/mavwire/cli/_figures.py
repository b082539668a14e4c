"""Opening what is drawn on, with errors that say what is missing."""

from __future__ import annotations

from typing import TYPE_CHECKING

from mavwire.cli._errors import CommandError

if TYPE_CHECKING:
    from mavwire.plots.windows import Figures


def open_figures(output: str | None, option: str = "--image") -> Figures:
    """Figures for windows, or for the image `output` that `option` names; CommandError where there can
    be none.
    """
    from mavwire.plots.windows import Figures

    try:
        return Figures(output)
    except RuntimeError as error:
        raise CommandError(f"{error}; {option} FILE draws an image") from error
    except (ImportError, ValueError) as error:
        raise CommandError(str(error)) from error
