"""`contextmanager` for what every command needs: `contextlib` takes as long to import as `mavutil`
without its dialect, since it brings `collections` and `functools` along.
"""

from __future__ import annotations

__all__ = ["contextmanager"]

TYPE_CHECKING = False
if TYPE_CHECKING:
    from contextlib import contextmanager
else:

    class _Context:
        """What a generator function that yields once does, as a context or around a function."""

        def __init__(self, function, arguments, options):
            self._parts = function, arguments, options

        def __enter__(self):
            function, arguments, options = self._parts
            self._generator = function(*arguments, **options)
            return next(self._generator)

        def __exit__(self, kind, error, traceback):
            if error is None:
                next(self._generator, None)
                return False
            try:
                self._generator.throw(error)
            except StopIteration:
                return True  # it was dealt with
            except BaseException as raised:
                # A generator must not pass a StopIteration on as it is.
                is_wrapped = isinstance(error, StopIteration) and raised.__cause__ is error
                if raised is not error and not is_wrapped:
                    raise
                error.__traceback__ = traceback  # without the generator's own lines
            return False

        def __call__(self, function):
            def run(*arguments, **options):
                with _Context(*self._parts):
                    return function(*arguments, **options)

            for name in ("__module__", "__name__", "__qualname__", "__doc__"):
                setattr(run, name, getattr(function, name))
            run.__wrapped__ = function  # whose signature it has
            return run

    def contextmanager(function):
        """As `contextlib.contextmanager`."""

        def begin(*arguments, **options):
            return _Context(function, arguments, options)

        begin.__doc__ = function.__doc__
        return begin
