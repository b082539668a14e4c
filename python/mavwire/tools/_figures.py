"""Opening what is drawn on, with errors that say what is missing."""

from __future__ import annotations

from mavwire.cli._errors import CommandError

TYPE_CHECKING = False
if TYPE_CHECKING:
    from mavwire.plots.windows import Figures


def open_figures(output: str | None) -> Figures:
    """Figures for windows, or for the image `output`; CommandError where there can be none."""
    from mavwire.plots.windows import Figures

    try:
        return Figures(output)
    except (ImportError, RuntimeError, ValueError) as error:
        raise CommandError(str(error)) from error
