"""Parameters of a vehicle as a dictionary, and the files they are kept in: pymavlink's `mavparm`."""

from __future__ import annotations

import struct
import sys
import time
from collections.abc import Callable, Mapping
from typing import Any

from mavwire import _parameter_file, mavutil
from mavwire._atomic_file import replace_text
from mavwire._hooks import IN_STANDARD_MODULE, ReplaceableModule, make_replaceable
from mavwire._parameter_file import (
    EXCLUDED,
    SMALLEST_DIFFERENCE,
    differences,
    heading,
    matches,
    number_of,
    read_parameter_file,
)
from mavwire.links.param_bytes import INTEGERS


class _Mavparm(ReplaceableModule):
    _not_called = {"fnmatch": IN_STANDARD_MODULE}  # noqa: RUF012


make_replaceable(sys.modules[__name__], _Mavparm)

MAVParmFileError = _parameter_file.MAVParmFileError
TRY_SECONDS = 1.0


class MAVParmDict(dict[str, Any]):
    """Parameters by name.

    `exclude_load` names those that belong to one vehicle and not into another; `mindelta` is the
    largest difference that does not count as one.
    """

    def __init__(self, *args: tuple[str, Any] | Mapping[str, Any]) -> None:
        super().__init__()
        for one in args:
            self.update(one if isinstance(one, Mapping) else (one,))
        self.exclude_load = list(EXCLUDED)
        self.mindelta = SMALLEST_DIFFERENCE

    # -- the vehicle

    def mavset(
        self, mav: Any, name: str, value: Any, retries: int = 3, parm_type: int | None = None
    ) -> bool:
        """Set a parameter over the link `mav` and wait for the vehicle's answer, a second a try.

        Returns whether an answer came. A `value` may be text, hexadecimal with a leading 0x; with
        an integer `parm_type` the float carries its bits.
        """
        try:
            sent = _as_float(value, parm_type)
        except struct.error as error:
            raise ValueError(f"{name}: {value} does not fit type {parm_type}: {error}") from error
        if sent is None:
            print(f"can't send {name} of type {parm_type}")
            return False
        for _ in range(retries):
            mav.param_set_send(name.upper(), sent, parm_type=parm_type)
            if _answered(mav, name.upper()):
                self[name] = sent
                return True
        print(f"timeout setting {name} to {sent:f}")
        return False

    # -- files

    def save(self, filename: str, wildcard: str = "*", verbose: bool = False) -> None:
        """Write the parameters whose names match `wildcard`, sorted; `verbose` says how many."""
        lines = []
        for name in sorted(self):
            if name and matches(name, wildcard):
                value = self[name]
                text = f"{value:f}" if isinstance(value, float) else str(value)
                lines.append(f"{name:<16.16} {text}\n")
        replace_text(filename, "".join(lines))
        if verbose:
            print(f"Saved {len(lines)} parameters to {filename}")

    def load(
        self,
        filename: str,
        wildcard: str = "*",
        mav: Any = None,
        check: bool = True,
        use_excludes: bool = True,
    ) -> bool:
        """Read a parameter file; False, and a text on standard output, when it cannot be opened.
        A warning on standard error says that a file has no parameters.

        With a link `mav` the values that differ are set on the vehicle, and `check` leaves out
        those that it does not have. Raises MAVParmFileError for a value that is no number.
        """
        try:
            file = read_parameter_file(
                filename, wildcard, self.exclude_load if use_excludes else ()
            )
        except MAVParmFileError:
            raise
        except (OSError, TypeError, ValueError) as error:  # the last two for what is no name
            print(f"Failed to open file '{filename}': {error}")
            return False
        if mav is None:
            for name, value in file.values:  # by a program's own __setitem__
                self[name] = value
            file.show_loaded()
            return True
        file.show_invalid()
        file.warn_if_empty()
        known = [self._upload(mav, name, value, check) for name, value in file.values]
        changed = sum(state == "changed" for state in known)
        count = len(known) - known.count("unknown")
        print(f"Loaded {count} parameters from {filename} (changed {changed})")
        return True

    def _upload(self, mav: Any, name: str, value: float, check: bool) -> str:
        """Bring one value of a file to the vehicle; what became of it."""
        if check:
            if name not in self:
                print(f"Unknown parameter {name}")
                return "unknown"
            old = self[name]
            if abs(old - value) <= self.mindelta:
                return "same"
            if self._set_as_written(mav, name, value):
                print(f"changed {name} from {old:f} to {value:f}")
        else:
            print(f"set {name} to {value:f}")
            self._set_as_written(mav, name, value)
        return "changed"

    def _set_as_written(self, mav: Any, name: str, value: float) -> bool:
        """Set a value of a file; an integer of the file stays one here."""
        done = self.mavset(mav, name, value)
        if done:
            self[name] = value
        return done

    # -- showing

    def show_param_value(self, name: str, value: Any) -> None:
        """Print a name and a value."""
        print(f"{name:<16.16} {value}")

    def show(self, wildcard: str = "*") -> None:
        """Print the parameters whose names match `wildcard`, sorted."""
        for name in sorted(self):
            if matches(name, wildcard):
                value = self[name]
                self.show_param_value(name, value if isinstance(value, str) else f"{value:f}")

    def diff(
        self,
        filename: str,
        wildcard: str = "*",
        use_excludes: bool = True,
        use_tabs: bool = False,
        show_only1: bool = True,
        show_only2: bool = True,
        header: bool = False,
        value_info: Callable[[str, Any], Any] | None = None,
    ) -> None:
        """Print where the file, in the first column, differs from these parameters, in the second.

        `show_only1` and `show_only2` include what only the file or only the dictionary has;
        `value_info(name, value)` explains a value in a comment; None is no explanation.
        """
        other = MAVParmDict()
        if not other.load(filename, use_excludes=use_excludes):
            return
        if header:
            print(heading(use_tabs))
        for line in differences(
            other,
            self,
            wildcard=wildcard,
            smallest=self.mindelta,
            tabs=use_tabs,
            only_first=show_only1,
            only_second=show_only2,
            value_info=value_info,
        ):
            print(line)


def _as_float(value: Any, parm_type: int | None) -> float | None:
    """The value that PARAM_SET carries; None for a type that it cannot carry."""
    if parm_type is None or parm_type == mavutil.mavlink.MAV_PARAM_TYPE_REAL32:
        return number_of(value) if isinstance(value, str) else float(value)
    packing = INTEGERS.get(parm_type)
    if packing is None:
        return None
    whole = int(number_of(value) if isinstance(value, str) else value)
    result: float = struct.unpack("<f", struct.pack(packing, whole))[0]
    return result


def _answered(mav: Any, name: str) -> bool:
    """Whether the value of `name` arrives within a second."""
    deadline = time.monotonic() + TRY_SECONDS
    while (left := deadline - time.monotonic()) > 0:
        answer = mav.recv_match(type="PARAM_VALUE", blocking=True, timeout=left)
        if answer is not None and str(answer.param_id).upper() == name:
            return True
    return False
