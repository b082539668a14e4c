"""The installed-package record of the alias, for programs that ask for pymavlink's version by
metadata.
"""

from __future__ import annotations

import os
from importlib.metadata import Distribution, DistributionFinder, MetadataPathFinder
from pathlib import Path


def installed_folder() -> Path | None:
    """The folder of an installed pymavlink, with or without the alias; None if it is not installed."""
    context = DistributionFinder.Context(name="pymavlink")
    for installed in MetadataPathFinder.find_distributions(context):
        return Path(str(installed.locate_file("")))
    return None


class AliasDistribution(Distribution):
    """``pymavlink`` as a distribution without files."""

    def __init__(self, version: str) -> None:
        self._files = {
            "METADATA": f"Metadata-Version: 2.1\nName: pymavlink\nVersion: {version}\n"
            "Summary: Provided by mavwire\n",
            "top_level.txt": "pymavlink\n",
        }

    def read_text(self, filename: str) -> str | None:
        return self._files.get(filename)

    def locate_file(self, path: str | os.PathLike[str]) -> Path:
        """Where the file would be: in an installed pymavlink, else beside mavwire, where there is
        none.
        """
        return (installed_folder() or Path(__file__).parent.parent) / path
