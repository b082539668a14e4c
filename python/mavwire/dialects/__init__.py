"""MAVLink dialects as Python modules.

``mavwire.dialects.v20.ardupilotmega`` and its siblings offer what pymavlink's generated modules offer. None of them holds
generated code: a module is a namespace filled from a dialect of the native core, and message classes come into being when
they are first used. :func:`load` makes such a module from XML at run time, :func:`populate` fills a namespace that is
there already (the files that ``mavgen`` writes call it).
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    import os
    from types import ModuleType
    from typing import Any

    from mavwire._native import Dialect

__all__ = ["UPSTREAM", "load", "merged", "names", "populate", "populate_builtin"]

UPSTREAM = "upstream"
"""The dialect with every message of mavlink/mavlink and ArduPilot/mavlink: the default of all that pymavlink lacks."""


def names() -> list[str]:
    """Names of the built-in dialects."""
    from mavwire._native import Dialect

    return sorted(Dialect.names())


def module_within(package: str, name: str) -> ModuleType:
    """A built-in dialect that was not imported yet, for the packages `v10` and `v20`: programs that import `mavutil` find
    the current one there without an import of their own.
    """
    if name not in names():
        raise AttributeError(f"module {package!r} has no attribute {name!r}")
    from importlib import import_module

    return import_module(f"{package}.{name}")


if not TYPE_CHECKING:

    def __getattr__(name: str) -> object:
        if name not in ("v10", "v20"):
            raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
        return __import__(f"{__name__}.{name}", fromlist=[name])


def populate_builtin(namespace: dict[str, Any]) -> None:
    """Fills the globals of ``mavwire.dialects.v10.<name>`` or ``v20.<name>``."""
    from mavwire._native import Dialect
    from mavwire.dialects import _module

    package, _, name = namespace["__name__"].rpartition(".")
    wire_protocol = "1.0" if package.endswith(".v10") else "2.0"
    native = None
    if name == UPSTREAM:
        from mavwire.dialects import _installed

        native = _installed.dialect(wire_protocol)
    _module.fill(namespace, native or Dialect.builtin(name, wire_protocol), name)


def populate(
    namespace: dict[str, Any],
    *,
    name: str,
    wire_protocol: str,
    sources: dict[str, str],
    main: str,
) -> None:
    """Fills ``namespace`` with the dialect ``main`` of ``sources`` (base name -> XML text).

    ``name`` is what ``DIALECT`` shall say. Includes are looked up in ``sources`` and then among the built-in dialects.
    Raises ``DefinitionError`` (a ``ValueError``) naming file, line and reason where a definition is wrong.
    """
    from mavwire._native import Dialect
    from mavwire.dialects import _module

    _module.fill(namespace, Dialect.from_sources(main, sources, wire_protocol), name)


def load(
    path: str | os.PathLike[str], wire_protocol: str = "2.0", name: str | None = None
) -> ModuleType:
    """A dialect module from an XML file, with nothing written to disk.

    ``path`` names the file; its includes are looked for beside it and among the built-in dialects. A text that starts
    with ``<`` is taken as XML itself. The module is entered in ``sys.modules`` under ``mavwire.dialects.loaded.<name>``
    so that its messages can be pickled within the process; loading the same name again replaces it there. Raises
    ``OSError`` for a file that cannot be read and ``DefinitionError`` naming file, line and reason.
    """
    from mavwire._native import DefinitionError, Dialect
    from mavwire.dialects import _sources

    main, sources = _sources.collect(path, name)
    try:
        native = Dialect.from_sources(main, sources, wire_protocol)
    except DefinitionError as error:
        raise DefinitionError(_sources.told_of(error, path, main)) from None
    return _loaded(native, main)


def merged(modules: list[ModuleType]) -> ModuleType:
    """One dialect of several, which is entered in ``sys.modules`` like those of :func:`load`.

    The first that knows a message id names it. The layouts that the others have for it are known by their ``CRC_EXTRA``.
    A UserWarning tells where a message has another name, since that of its dialect is one of another id.
    """
    from mavwire._native import Dialect

    first, *others = (module.MAVLink(None)._dialect for module in modules)
    if not others:
        return modules[0]
    native = Dialect.merged(first, others)
    name = "+".join(module.DIALECT for module in modules)
    _warn_renamed(native, others, name)
    return _loaded(native, name)


def _warn_renamed(native: Dialect, others: list[Dialect], name: str) -> None:
    import warnings

    found = {msgid: found for found, msgid in native.messages()}
    own = {(msgid, theirs) for other in others for theirs, msgid in other.messages()}
    for msgid, theirs in sorted(own):
        if found[msgid].startswith(f"{theirs}_CRC"):
            text = f"{theirs} of id {msgid} is {found[msgid]} in the dialect {name}: another id has that name"
            warnings.warn(text, stacklevel=3)


def _loaded(native: Dialect, name: str) -> ModuleType:
    import sys
    from types import ModuleType

    from mavwire._hooks import make_replaceable
    from mavwire.dialects import _module
    from mavwire.dialects._replaced import DialectModule

    text = f"MAVLink dialect {name}, loaded at run time."
    module = ModuleType(f"mavwire.dialects.loaded.{name}", text)
    _module.fill(module.__dict__, native, name)
    make_replaceable(module, DialectModule)
    sys.modules[module.__name__] = module
    return module
