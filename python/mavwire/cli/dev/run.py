"""Run a program that imports pymavlink, unchanged, on mavwire.

  mavwire run script.py [arguments]
  mavwire run -m module [arguments]

The program sees what "python script.py" would show it: sys.argv, sys.path, __main__, exit codes and
tracebacks. A name that is no file here is looked for among the installed scripts: mavwire run
mavproxy.py. Processes that the program starts are not affected; "mavwire alias --enable" covers
these too.
"""

from __future__ import annotations

import os
import pkgutil
import runpy
import shutil
import sys
import sysconfig
from argparse import REMAINDER, ArgumentParser
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.machinery import SourceFileLoader
from types import ModuleType, TracebackType
from typing import NoReturn

from mavwire._alias import AliasError, install_as_pymavlink
from mavwire.cli._errors import tell

PASS_THROUGH = True


def add_arguments(parser: ArgumentParser) -> None:
    """For the help text; :func:`main` reads the arguments itself, so that none of the program's is
    lost.
    """
    parser.usage = "mavwire run [-m module | script] [arguments]"
    parser.add_argument("-m", dest="module", help="run a module, as python -m does")
    parser.add_argument("script", nargs="?", help="run a script, a folder or zip with __main__.py")
    parser.add_argument("arguments", nargs=REMAINDER, help="arguments of the program")


def main(arguments: list[str]) -> int:
    """Run the program; its exceptions and SystemExit pass through."""
    if arguments[:1] == ["--"]:
        arguments = arguments[1:]
    if not arguments or arguments == ["-m"]:
        _say("error: name a script, or a module after -m")
        return 2
    if arguments[0].startswith("-") and arguments[0] != "-m":
        _say(f"error: unknown option {arguments[0]}")
        return 2
    try:
        install_as_pymavlink()
    except AliasError as error:
        _fail(str(error))
    if arguments[0] == "-m":
        _run_module(arguments[1], arguments[2:])
    else:
        _run_script(arguments[0], arguments[1:])
    return 0


def _run_script(name: str, arguments: list[str]) -> None:
    path = _find_script(name)
    sys.argv = [path, *arguments]
    if pkgutil.get_importer(path) is not None:  # a folder, or a zip archive
        _set_first_path(os.path.abspath(path))
        _run_as_main("__main__", alter_argv=False)
        return
    with open(path, "rb") as file:
        source = file.read()
    _set_first_path(os.path.dirname(os.path.realpath(path)))
    main = _main_module()
    main.__file__ = os.path.abspath(path)
    main.__loader__ = SourceFileLoader("__main__", main.__file__)
    with _own_frames_hidden(main):
        exec(compile(source, main.__file__, "exec", dont_inherit=True), main.__dict__)


def _run_module(name: str, arguments: list[str]) -> None:
    sys.argv = ["-m", *arguments]
    _set_first_path(os.getcwd())
    _run_as_main(name, alter_argv=True)


def _run_as_main(name: str, alter_argv: bool) -> None:
    """Run a module as the interpreter does for `-m` and for folders."""
    with _own_frames_hidden(_main_module()):
        runpy._run_module_as_main(name, alter_argv)  # type: ignore[attr-defined]


def _main_module() -> ModuleType:
    """A fresh ``__main__`` that stays in place, as the interpreter's own does: threads and pickle
    look it up.
    """
    main = ModuleType("__main__")
    main.__dict__["__builtins__"] = sys.modules["builtins"]
    sys.modules["__main__"] = main
    return main


@contextmanager
def _own_frames_hidden(main: ModuleType) -> Iterator[None]:
    try:
        yield
    except SystemExit:
        raise
    except BaseException:
        _hide_own_frames(main)
        raise


def _hide_own_frames(main: ModuleType) -> None:
    """Let the interpreter's report of an uncaught exception begin with the program's own frame."""
    report = sys.excepthook

    def excepthook(
        kind: type[BaseException], error: BaseException, trace: TracebackType | None
    ) -> None:
        while trace is not None and trace.tb_frame.f_globals is not main.__dict__:
            trace = trace.tb_next
        report(kind, error.with_traceback(trace), trace)

    sys.excepthook = excepthook


def _find_script(name: str) -> str:
    if os.path.exists(name):
        return name
    if not os.path.dirname(name):
        scripts = sysconfig.get_path("scripts")
        found = shutil.which(name, path=scripts, mode=os.F_OK) or shutil.which(name)
        if found:
            return found
    _fail(f"can't open file '{os.path.abspath(name)}': No such file or directory", exit_code=2)


def _set_first_path(entry: str) -> None:
    """Set the first entry of ``sys.path`` as the interpreter does, unless it was started with ``-P`` or
    ``-I``.
    """
    if not sys.flags.safe_path:
        sys.path[0] = entry


def _fail(reason: str, exit_code: int = 1) -> NoReturn:
    _say(reason)
    raise SystemExit(exit_code)


def _say(text: str) -> None:
    if sys.stderr is not None:  # for which `print` would take standard output
        tell(f"mavwire run: {text}")
