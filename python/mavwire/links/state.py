"""The state that all links of a process share.

pymavlink keeps this in the globals of `mavutil`, and its users read and assign them there:
`mavutil.mavlink`, `mavutil.mavfile_global` and so on. They live here, and `mavutil` shows them as
properties, so that no link has to import `mavutil`. The choice of the wire protocol is a plain
variable: the process environment is read, never written.
"""

from __future__ import annotations

import os
import sys
from _thread import RLock  # `threading` takes as long to load as all of `mavutil`
from contextvars import ContextVar
from types import ModuleType

from . import Any

DEFAULT_DIALECT = "all"
DIALECTS = "mavwire.dialects"

# The current dialect module. Replaced when the dialect or the wire protocol changes. One that is
# postponed is no global until somebody asks for it: what reads a log of MAVLink 2 never needs the
# module for version 1, which takes longer to load than the rest of `mavutil`.
mavlink: Any = None
# The wire protocol of a postponed module.
_postponed: str = "1.0"
current_dialect: str = DEFAULT_DIALECT
# Held where a dialect is made current and then taken for a link.
choosing = RLock()
# The dialect of the link that is being opened, which other threads do not change.
asked_for: ContextVar[ModuleType | None] = ContextVar("asked_for", default=None)
# The module, or the list of dialects, that `set_dialect` was given in place of a name, else None.
_given: Any = None
# The link or log reader opened last; expressions read parameters from it.
mavfile_global: Any = None
# The link_id that the next `setup_signing` without an explicit one takes.
global_link_id: int = 0
# The module that users import, `mavutil`, once it has loaded: where a program that replaces a
# link class or a function puts its own.
public: Any = None
# "1.0" or "2.0" once a user or a received frame has decided; None leaves it to the environment.
wire_protocol: str | None = None


# The variables that say which definitions are in use.
_DEFINITIONS = ("wire_protocol", "mavlink", "_postponed", "current_dialect", "_given")


def __getattr__(name: str) -> Any:
    if name != "mavlink":
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    global mavlink
    mavlink = load_dialect(current_dialect, _postponed)
    return mavlink


def is_postponed() -> bool:
    """Whether nobody has asked for the current dialect module yet."""
    return "mavlink" not in globals()


def delete_mavlink() -> None:
    """The current dialect's module is loaded anew when somebody asks for it."""
    global _postponed
    globals().pop("mavlink", None)
    _postponed = _chosen_version()


def dialect_of_new_links() -> ModuleType:
    """The dialect that a link of this thread was asked to have, or else the current one."""
    module: ModuleType = asked_for.get() or sys.modules[__name__].mavlink  # it may be postponed
    return module


def definitions_in_use() -> dict[str, Any]:
    """The dialect and wire protocol, for `use_definitions` to come back to."""
    own = globals()
    return {name: own[name] for name in _DEFINITIONS if name in own}


def use_definitions(kept: dict[str, Any]) -> None:
    """Go back to what `definitions_in_use` gave."""
    globals().pop("mavlink", None)
    globals().update(kept)


def mavlink20() -> bool:
    """Whether dialects are taken from the v20 package."""
    if wire_protocol is None:
        return "MAVLINK20" in os.environ
    return wire_protocol == "2.0"


def set_wire_protocol(version: str | None) -> None:
    """Choose the protocol of the current dialect and of all that are set from now on. Links that are open
    keep theirs.

    `version` is "1.0", "2.0", or None for what MAVLINK20 in the environment says. ValueError
    for anything else; FileNotFoundError where the current dialect is from a file that is gone.
    """
    global wire_protocol
    if version not in ("1.0", "2.0", None):
        raise ValueError(f"wire protocol must be '1.0', '2.0' or None, not {version!r}")
    before, wire_protocol = wire_protocol, version
    current = _postponed if is_postponed() else getattr(mavlink, "WIRE_PROTOCOL_VERSION", None)
    if mavlink20() == (current == "2.0"):
        return
    try:
        renew_dialect()
    except BaseException:
        wire_protocol = before
        raise


def set_dialect(dialect: Any) -> None:
    """Make `dialect` current: the name of a built-in one, of one in $MDEF, a path to XML, or a
    dialect module, which is taken for both wire protocols. Of a list the first that knows an id names it.

    FileNotFoundError says what there is in place of an unknown dialect; TypeError for anything
    else than a name, a path, a module or a list of these.
    """
    global mavlink, current_dialect, _given
    if isinstance(dialect, list | tuple) and dialect:
        merged: Any = import_module(DIALECTS).merged
        mavlink = merged([_loaded(one) for one in dialect])
        current_dialect, _given = mavlink.DIALECT, dialect
    else:
        mavlink = _loaded(dialect)
        _given = dialect if dialect is mavlink else None
        current_dialect = mavlink.DIALECT if dialect is mavlink else os.fspath(dialect)
    if asked_for.get() is not None:  # a log of the other wire protocol is being opened
        asked_for.set(mavlink)


def _loaded(dialect: Any) -> ModuleType:
    """The module of one dialect. TypeError for anything else than a name, a path or a module."""
    if isinstance(dialect, ModuleType):
        _check_module(dialect)
        return dialect
    if not isinstance(dialect, str | os.PathLike):
        raise _no_dialect_type(dialect)
    return load_dialect(os.fspath(dialect), _chosen_version())


def choose_dialect(dialect: str | list[str]) -> None:
    """As `set_dialect`, but the module of a built-in dialect is loaded when somebody asks for it."""
    global _postponed, current_dialect, _given
    version = _chosen_version()
    if (
        isinstance(dialect, list)
        or _module_name(dialect, version) in sys.modules
        or not _is_built_in(dialect)
    ):
        set_dialect(dialect)
        return
    globals().pop("mavlink", None)
    _postponed, current_dialect, _given = version, dialect, None


def renew_dialect() -> None:
    """Take the current dialect again, of the wire protocol that is chosen now."""
    if is_postponed():
        choose_dialect(current_dialect)
    else:
        is_kept = _given is mavlink or getattr(mavlink, "DIALECT", None) == current_dialect
        set_dialect(_given if _given is not None and is_kept else current_dialect)


def _chosen_version() -> str:
    return "2.0" if mavlink20() else "1.0"


def _is_built_in(dialect: str) -> bool:
    if dialect == DEFAULT_DIALECT:
        return True
    from mavwire._native import Dialect

    return dialect in Dialect.names()


def _check_module(module: ModuleType) -> None:
    if not isinstance(getattr(module, "DIALECT", None), str) or not hasattr(module, "MAVLink"):
        raise _no_dialect_type(module)


def _no_dialect_type(dialect: object) -> TypeError:
    wanted = "a name, a path to XML, a dialect module or a list of these"
    return TypeError(f"dialect must be {wanted}, not {dialect!r}")


def load_dialect(dialect: str, version: str) -> ModuleType:
    """The module of `dialect` for wire protocol `version` ("1.0" or "2.0")."""
    if dialect.endswith(".xml"):
        return _load_definitions(dialect, version)
    if dialect.isidentifier():
        name = _module_name(dialect, version)
        try:
            return import_module(name)
        except ModuleNotFoundError as error:
            if error.name != name:
                raise
    path = _definitions_path(dialect)
    if not os.path.isfile(path):
        import errno

        from mavwire._text import no_such_dialect

        looked_for = (path,) if "MDEF" in os.environ else ()
        raise FileNotFoundError(errno.ENOENT, no_such_dialect(dialect), *looked_for)
    return _load_definitions(path, version)


def _module_name(dialect: str, version: str) -> str:
    return f"{DIALECTS}.{'v20' if version == '2.0' else 'v10'}.{dialect}"


def import_module(name: str) -> ModuleType:
    """As that of `importlib`, which takes longer to import than what it is asked for here."""
    __import__(name)
    return sys.modules[name]


def _definitions_path(dialect: str) -> str:
    """Where $MDEF, or the package's neighbour `message_definitions`, keeps this dialect."""
    here = os.path.dirname(os.path.abspath(__file__))
    default = os.path.join(os.path.dirname(os.path.dirname(here)), "message_definitions")
    return os.path.join(os.environ.get("MDEF", default), "v1.0", f"{dialect}.xml")


def _load_definitions(path: str, version: str) -> ModuleType:
    os.stat(path)  # raises what is wrong with the way there
    dialects: Any = import_module(DIALECTS)
    module: ModuleType = dialects.load(path, wire_protocol=version)
    return module
