"""A progress bar on stderr, only for a person who has been waiting.

Drawn by rich, if it is installed, which puts what is printed meanwhile above it.
"""

from __future__ import annotations

import sys
import time
from typing import Any

from mavwire._text import drawn_on, guard_streams, is_terminal, printable

PROGRESS_AFTER = 1.0
# Redrawing more often than this costs more than it tells.
PROGRESS_INTERVAL = 0.1


class Progress:
    """Shows how much of a file is read, until a `with` block ends. `enabled=False` keeps it silent."""

    def __init__(self, name: str, enabled: bool = True) -> None:
        self.name = printable(name)
        self.began = time.monotonic()
        self.enabled = enabled and is_terminal(sys.stderr)
        self.shown = False
        self._drawn_at = 0.0
        self._bar: Any = None
        self._task: Any = None
        self._escape: Any = None

    def update(self, percent: float, name: str | None = None) -> None:
        """Draw the bar, once reading has taken a while. `percent` is from 0 to 100; `name` is that of
        another file.
        """
        if not self.enabled:
            return
        now = time.monotonic()
        if now - self.began < PROGRESS_AFTER or now - self._drawn_at < PROGRESS_INTERVAL:
            return
        self._drawn_at = now
        self.name = self.name if name is None else printable(name)
        if not self.shown:
            self.shown = True
            self._start()
        if self._bar is not None:
            label = {} if name is None else {"description": self._escape(self.name)}
            self._bar.update(self._task, completed=percent, **label)

    def update_bytes(self, read: int, size: int) -> None:
        """Draw the bar for the bytes that were read of a file."""
        self.update(min(100.0, 100.0 * read / max(size, 1)))

    def __enter__(self) -> Progress:
        return self

    def __exit__(self, *_error: object) -> None:
        """Wipe the bar."""
        if self._bar is not None:
            self._bar.stop()
        self.enabled = False

    def _start(self) -> None:
        try:
            from rich.console import Console
            from rich.markup import escape
            from rich.progress import Progress as Bar
        except ImportError:
            return
        # Printed lines go above the bar, but not those that go to a file or a pipe.
        on_screen = is_terminal(sys.stdout)
        console = Console(file=drawn_on(sys.stderr))
        self._bar = Bar(console=console, transient=True, redirect_stdout=on_screen)
        self._escape = escape
        self._task = self._bar.add_task(escape(self.name), total=100)
        self._bar.start()
        guard_streams()  # till `stop` puts back what it found
