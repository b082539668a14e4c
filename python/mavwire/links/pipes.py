"""Writing to who has hung up, in a program that lets SIGPIPE end it.

Python ignores the signal; a program whose output goes to `head` may want it back, and means its standard output by that,
not the other end of a link.
"""

from __future__ import annotations

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Callable
    from typing import Any

try:
    # The function of `signal` makes a member of an enum of its answer, which takes longer than sending.
    from _signal import SIGPIPE, getsignal  # type: ignore[import-not-found]
except ImportError:  # Windows

    def ends_program() -> bool:
        """Whether writing to who has hung up would end the program."""
        return False

else:

    def ends_program() -> bool:
        """Whether writing to who has hung up would end the program."""
        return bool(getsignal(SIGPIPE) == 0)


def survived(write: Callable[..., Any], *arguments: Any) -> Any:
    """Call `write` with the signal held back, so that it raises BrokenPipeError instead."""
    import signal

    pipe = {signal.SIGPIPE}
    before = signal.pthread_sigmask(signal.SIG_BLOCK, pipe)
    try:
        return write(*arguments)
    finally:
        if signal.SIGPIPE not in before:
            if signal.SIGPIPE in signal.sigpending():
                signal.sigwait(pipe)
            signal.pthread_sigmask(signal.SIG_UNBLOCK, pipe)
