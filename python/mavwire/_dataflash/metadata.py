"""Documentation of log messages, which ArduPilot publishes for each vehicle as XML.

It is kept in `~/.pymavlink/LogMessages`, where pymavlink keeps it too.
"""

from __future__ import annotations

import os

from mavwire.links.modes import VEHICLES, dot_pymavlink

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any
    from xml.etree.ElementTree import Element

BASE_URL = "https://autotest.ardupilot.org/LogMessages"
DOWNLOAD_TIMEOUT_S = 30


class DFMetaData:
    """Documentation of the log messages of a reader's vehicle."""

    def __init__(self, parent: Any) -> None:
        self.parent = parent
        self.data: dict[str, Element] | None = None
        self.metadata_load_attempted = False

    dot_pymavlink = staticmethod(dot_pymavlink)

    @staticmethod
    def download_url(url: str) -> bytes | None:
        """The content at `url`. None where the download fails, with a printed line."""
        from urllib.request import urlopen

        try:
            with urlopen(url, timeout=DOWNLOAD_TIMEOUT_S) as response:
                content: bytes = response.read()
        except (OSError, ValueError) as error:
            print(f"Downloading {url} failed: {error}")
            return None
        return content

    @staticmethod
    def download() -> None:
        """Fetch the documentation of all vehicles."""
        directory = DFMetaData.dot_pymavlink("LogMessages")
        os.makedirs(directory, exist_ok=True)
        for vehicle in dict.fromkeys(VEHICLES.values()):
            content = DFMetaData.download_url(f"{BASE_URL}/{vehicle}/LogMessages.xml")
            if content is not None:
                with open(os.path.join(directory, f"{vehicle}.xml"), "wb") as file:
                    file.write(content)

    def reset(self) -> None:
        """Forget what was loaded."""
        self.data = None
        self.metadata_load_attempted = False

    def metadata_tree(self, verbose: bool = False) -> dict[str, Element] | None:
        """Message name -> XML element, None without documentation; `verbose` says what to do."""
        if not self.metadata_load_attempted:
            self.metadata_load_attempted = True
            self.data = self._load(verbose)
        return self.data

    def _load(self, verbose: bool) -> dict[str, Element] | None:
        from xml.etree import ElementTree

        vehicle = VEHICLES.get(self.parent.mav_type)
        if vehicle is None:
            return None
        path = DFMetaData.dot_pymavlink("LogMessages", f"{vehicle}.xml")
        if not os.path.exists(path):
            if verbose:
                print(f"There is no {path}: DFMetaData.download() fetches it.")
            return None
        try:
            root = ElementTree.parse(path).getroot()
        except (ElementTree.ParseError, OSError) as error:
            print(f"{path} cannot be read: {error}")
            return None
        return {str(one.get("name")): one for one in root.iter("logformat")}

    def _described(self, msg: str, verbose: bool = False) -> Element | None:
        tree = self.metadata_tree(verbose)
        return None if tree is None else tree.get(msg)

    def print_help(self, msg: str) -> None:
        """Print what a message type and its columns mean."""
        described = self._described(msg, verbose=True)
        if self.data is None:
            return
        if described is None:
            print(f"No help found for message: {msg}")
            return
        print(f"Log Message: {msg}\n{described.findtext('description', '')}\n")
        fields = [(str(f.get("name")), _unit(f), f) for f in described.iter("field")]
        names = max((len(name) for name, _, _ in fields), default=0)
        units = max((len(unit) for _, unit, _ in fields), default=0)
        for name, unit, field in fields:
            print(f"{name:<{names}} {unit:<{units}} : {field.findtext('description', '')}")

    def get_description(self, msg: str) -> str | None:
        """The description of a message type: empty if it is unknown, None without documentation."""
        described = self._described(msg)
        if self.data is None:
            return None
        return "" if described is None else described.findtext("description", "")


def _unit(field: Element) -> str:
    if field.find("bitmask") is not None:
        return "[bitmask]"
    unit = field.get("units")
    return f"[{unit}]" if unit else ""
