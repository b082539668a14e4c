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
import shutil
import sys
import sysconfig
from argparse import REMAINDER, ArgumentParser
from importlib import machinery, util
from importlib.machinery import ModuleSpec
from types import CodeType, ModuleType, TracebackType
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
    if arguments[0].startswith("-") and arguments[0] not in ("-", "-m"):
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
    if name == "-":
        sys.argv = [name, *arguments]
        _set_first_path("")
        _execute("<stdin>", sys.stdin.buffer.read(), _main_module(None))
        return
    path = _find_script(name)
    sys.argv = [path, *arguments]
    if _has_main(path):
        path = os.path.abspath(path)
        _set_first_path(path)
        spec = machinery.PathFinder.find_spec("__main__", [path])
        if spec is None:
            _fail(f"can't find '__main__' module in '{name}'")
        _run_spec(spec, name)
        return
    with open(path, "rb") as file:
        source = file.read()
    _set_first_path(os.path.dirname(os.path.realpath(path)))
    main = _main_module(None)
    main.__file__ = os.path.abspath(path)
    main.__loader__ = machinery.SourceFileLoader("__main__", main.__file__)
    _execute(main.__file__, source, main)


def _run_module(name: str, arguments: list[str]) -> None:
    sys.argv = ["-m", *arguments]
    _set_first_path(os.getcwd())
    try:
        spec = util.find_spec(name)
        if spec is not None and spec.submodule_search_locations is not None:
            spec = util.find_spec(name + ".__main__")
            if spec is None:
                _fail(
                    f"No module named {name}.__main__; "
                    f"'{name}' is a package and cannot be directly executed"
                )
    except (ModuleNotFoundError, ValueError) as error:
        _fail(f"Error while finding module specification for '{name}' ({error})")
    _run_spec(spec, name)


def _run_spec(spec: ModuleSpec | None, name: str) -> None:
    if spec is None:
        _fail(f"No module named {name}")
    loader = spec.loader
    code = loader.get_code(spec.name) if hasattr(loader, "get_code") else None  # type: ignore[union-attr]
    if code is None:
        _fail(f"No code object available for {name}")
    main = _main_module(spec)
    if sys.argv[0] == "-m":
        sys.argv[0] = spec.origin or name
    _execute(spec.origin or name, code, main)


def _main_module(spec: ModuleSpec | None) -> ModuleType:
    """A fresh ``__main__`` that stays in place, as the interpreter's own does: threads and pickle
    look it up.
    """
    main = ModuleType("__main__")
    main.__dict__["__builtins__"] = sys.modules["builtins"]
    if spec is not None:
        main.__spec__ = spec
        main.__package__ = spec.parent
        main.__loader__ = spec.loader
        main.__file__ = spec.origin
        main.__dict__["__cached__"] = spec.cached
    sys.modules["__main__"] = main
    return main


def _execute(filename: str, program: bytes | CodeType, main: ModuleType) -> None:
    try:
        code = program
        if isinstance(code, bytes):
            code = compile(code, filename, "exec", dont_inherit=True)
        exec(code, main.__dict__)
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


def _has_main(path: str) -> bool:
    if os.path.isdir(path):
        return True
    if not path.endswith((".zip", ".pyz", ".pyzw")):
        return False
    from zipfile import is_zipfile

    return is_zipfile(path)


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
