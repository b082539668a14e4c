"""The parser of options of all commands."""

from __future__ import annotations

from argparse import ArgumentParser

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any


class PlainParser(ArgumentParser):
    """An argparse parser whose texts have no colours, which Python 3.14 gives them on terminals: there the
    guard of commands shows escape sequences as text. Subparsers are of this class, too.
    """

    def __init__(self, *arguments: Any, **options: Any) -> None:
        super().__init__(*arguments, **options)
        self.color = False
