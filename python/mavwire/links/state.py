"""The state that all links of a process share.

pymavlink keeps this in the globals of `mavutil`, and its users read and assign them there:
`mavutil.mavlink`, `mavutil.mavfile_global` and so on. They live here, and `mavutil` shows them as
properties, so that no link has to import `mavutil`. The choice of the wire protocol is a plain
variable: the process environment is read, never written.
"""

from __future__ import annotations

import os
from types import ModuleType

TYPE_CHECKING = False
if TYPE_CHECKING:
    from typing import Any

DEFAULT_DIALECT = "all"
DIALECTS = "mavwire.dialects"

# The current dialect module. Replaced when the dialect or the wire protocol changes.
mavlink: Any = None
current_dialect: str = DEFAULT_DIALECT
# The link or log reader opened last; expressions read parameters from it.
mavfile_global: Any = None
# The link_id that the next `setup_signing` without an explicit one takes.
global_link_id: int = 0
# The module that users import, `mavutil`, once it has loaded: where a program that replaces a
# link class or a function puts its own.
public: Any = None
# "1.0" or "2.0" once a user or a received frame has decided; None leaves it to the environment.
wire_protocol: str | None = None


def mavlink20() -> bool:
    """Whether dialects are taken from the v20 package."""
    if wire_protocol is None:
        return "MAVLINK20" in os.environ
    return wire_protocol == "2.0"


def set_wire_protocol(version: str | None) -> None:
    """Choose the protocol of all dialects set from now on.

    `version` is "1.0", "2.0", or None for what MAVLINK20 in the environment says. ValueError
    for anything else. Call `set_dialect` afterwards to replace the current dialect module.
    """
    global wire_protocol
    if version not in ("1.0", "2.0", None):
        raise ValueError(f"wire protocol must be '1.0', '2.0' or None, not {version!r}")
    wire_protocol = version


def set_dialect(dialect: str) -> None:
    """Make `dialect` current: the name of a built-in one, of one in $MDEF, or a path to XML.

    FileNotFoundError names the XML file that would have defined an unknown dialect.
    """
    global mavlink, current_dialect
    mavlink = load_dialect(dialect, "2.0" if mavlink20() else "1.0")
    current_dialect = dialect


def load_dialect(dialect: str, version: str) -> ModuleType:
    """The module of `dialect` for wire protocol `version` ("1.0" or "2.0")."""
    if dialect.endswith(".xml"):
        return _load_definitions(dialect, version)
    if dialect.isidentifier():
        package = DIALECTS + (".v20" if version == "2.0" else ".v10")
        try:
            return _import(f"{package}.{dialect}")
        except ModuleNotFoundError as error:
            if error.name != f"{package}.{dialect}":
                raise
    return _load_definitions(_definitions_path(dialect), version)


def _import(name: str) -> ModuleType:
    from importlib import import_module

    return import_module(name)


def _definitions_path(dialect: str) -> str:
    """Where $MDEF, or the package's neighbour `message_definitions`, keeps this dialect."""
    here = os.path.dirname(os.path.abspath(__file__))
    default = os.path.join(os.path.dirname(os.path.dirname(here)), "message_definitions")
    return os.path.join(os.environ.get("MDEF", default), "v1.0", f"{dialect}.xml")


def _load_definitions(path: str, version: str) -> ModuleType:
    if not os.path.isfile(path):
        import errno

        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), path)
    dialects: Any = _import(DIALECTS)
    module: ModuleType = dialects.load(path, wire_protocol=version)
    return module
