"""Figures of matplotlib that go to windows, or to image files."""

from __future__ import annotations

import os
from io import BytesIO
from typing import Any

from mavwire._atomic_file import replacing
from mavwire._signals import ended_in_order
from mavwire._text import cannot_write

NEEDED = "matplotlib is needed for figures: pip install 'mavwire[plot]'"
NO_DISPLAY = "there is no display for a window"
BLIND = frozenset(("agg", "cairo", "pdf", "pgf", "ps", "svg", "template"))
"""Backends of matplotlib that open no windows."""


class Figures:
    """Figures for the image file `output`, or for windows if it is None.

    Raises ImportError without matplotlib. ValueError is for an image that it does not write, and for
    windows without a display; `option` draws an image then.
    """

    def __init__(self, output: str | None, option: str = "--image") -> None:
        try:
            import matplotlib
            from matplotlib.backends.backend_agg import FigureCanvasAgg
            from matplotlib.figure import Figure
        except ImportError as error:
            raise ImportError(NEEDED) from error
        self._output = output
        self._figures: dict[str, Any] = {}
        if output is None:
            if matplotlib.get_backend().lower() in BLIND:
                raise ValueError(f"{NO_DISPLAY}; {option} FILE draws an image")
            return
        formats = FigureCanvasAgg(Figure()).get_supported_filetypes()
        if os.path.splitext(output)[1].removeprefix(".").lower() not in formats:
            raise ValueError(cannot_write(output, [f".{one}" for one in sorted(formats)]))

    def figure(self, name: str, **options: Any) -> Any:
        """A new figure; the options are matplotlib's."""
        if self._output is None:
            from matplotlib import pyplot

            self._figures[name] = pyplot.figure(num=name or None, **options)
        else:
            from matplotlib.figure import Figure

            self._figures[name] = Figure(**options)
        return self._figures[name]

    def finish(self) -> list[str]:
        """Show the windows until they are closed, or write the images; the names of these.

        Of several figures each has an image with its name: `out-ACC1.png`.
        """
        if self._output is None:
            from matplotlib import pyplot

            pyplot.show()
            return []
        root, suffix = os.path.splitext(self._output)
        paths = []
        for name, figure in self._figures.items():
            paths.append(self._output if len(self._figures) == 1 else f"{root}-{name}{suffix}")
            with ended_in_order(), replacing(paths[-1]) as file:
                image = BytesIO()  # not the file, whose passing name .svgz would keep
                figure.savefig(image, format=suffix[1:].lower())
                file.write(image.getbuffer())
        return paths
