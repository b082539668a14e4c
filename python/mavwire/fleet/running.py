"""`convert` and `to_parquet`: a fleet of logs to files.

The client hands out tasks and keeps the manifest; workers read logs and write files. A task that is
in the manifest is not done again.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from typing import Any, Unpack

from mavwire._text import in_words
from mavwire.dialects import UPSTREAM
from mavwire.logs.conversion import prepare
from mavwire.logs.manifest import Converted, Manifest
from mavwire.logs.query import Query, takes
from mavwire.logs.reading import allow_described
from mavwire.logs.store import remove_left, staging

from .clients import connected
from .cuts import find_cuts
from .grouping import TASK_BYTES, check_at_least_1, group_bytes, grouped, may_be_cut
from .places import Part, expand, is_url, statuses
from .stores import store_of
from .tasks import Piece, Recipe, convert_pieces


def to_parquet(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    out: str | os.PathLike[str],
    client: Any = None,
    **options: Any,
) -> list[Converted]:
    """Convert logs to `out/MESSAGE/LOG.parquet`; `convert` has the options."""
    return convert(paths, out, client, format="parquet", **options)


@takes(Query)
def convert(
    paths: str | os.PathLike[str] | Iterable[str | os.PathLike[str]],
    out: str | os.PathLike[str],
    client: Any = None,
    *,
    workers: int | None = None,
    format: str = "parquet",
    compression: str | None = None,
    types: str | Iterable[str] | None = None,
    csv_safe: bool = True,
    dialect: str | os.PathLike[str] = UPSTREAM,
    task_bytes: int = TASK_BYTES,
    storage_options: Mapping[str, Any] | None = None,
    progress: Callable[[int, int], object] | None = None,
    **query: Unpack[Query],
) -> list[Converted]:
    """Convert logs to `out/MESSAGE/LOG.parquet` (or .csv, .jsonl, .arrow) on a Dask cluster.

    `paths` are paths, patterns such as `logs/**/*.tlog`, and URLs of fsspec, one or several; `out`
    is a folder that all workers see, or a URL. `client` is a `distributed.Client` or the address of
    a scheduler; None is a cluster of `workers` processes on this machine, one for each processor.
    `progress` is told how many logs are done, of how
    many. The other arguments, and what is returned, are those of `mavwire.logs.conversion.convert`.

    Small logs are done together and large ones in parts of at least `task_bytes`, which give exactly
    the rows of the whole. A log that is missing or cannot be read is a row with an `error`. The tasks of a
    worker that dies are done by another one; nothing is there twice. A run that is
    interrupted goes on where it stopped when it is started again. ImportError where Dask is not
    installed, OSError where the scheduler is gone, ValueError for an argument that makes no sense,
    and while another run writes to the folder `out`.
    """
    logs = expand(paths, storage_options)
    compression, _, selection, how = prepare(
        format, compression, types, dialect, csv_safe=csv_safe, logs=logs, **query
    )
    check_at_least_1(workers=workers, task_bytes=task_bytes)
    allow_described(logs, selection)
    out = os.fsdecode(out).removeprefix("file://")
    known = statuses(logs, storage_options)
    store = store_of(out, storage_options)
    with store.locked(), _staging(out) as folder:
        manifest = Manifest(store, how, lambda path: _known(known[path]))
        names = manifest.names(logs)
        options = dict(storage_options or {})
        recipe = Recipe(out, folder, selection, dialect, format, compression, options)
        run = _Run(manifest, recipe, task_bytes, progress)
        try:
            todo = run.look(names, known)
            with connected(client, workers) if todo else nullcontext() as cluster:
                run.begin(todo)
                if todo:
                    run.work(cluster, todo)
        finally:
            manifest.close()
    return [run.rows[path] for path in names]


@contextmanager
def _staging(out: str) -> Iterator[str | None]:
    """A folder for incomplete files on the disk of `out`, None for a place of fsspec."""
    if is_url(out):
        yield None
        return
    remove_left(out)
    with staging(out) as folder:
        yield folder


def _known(found: tuple[int, int] | Exception) -> tuple[int, int]:
    if isinstance(found, Exception):
        raise OSError(str(found))
    return found


class _Run:
    """Rows of the logs of one run, and what is still missing of them."""

    def __init__(
        self,
        manifest: Manifest,
        recipe: Recipe,
        task_bytes: int,
        progress: Callable[[int, int], object] | None,
    ) -> None:
        self.manifest = manifest
        self.recipe = recipe
        self.task_bytes = task_bytes
        self.progress = progress
        self.rows: dict[str, Converted] = {}
        self._logs = self._done = 0
        self._failed: list[Converted] = []
        """Logs that cannot be read."""
        self._taken: set[str] = set()
        self._parts: dict[str, list[Converted]] = {}
        """Rows of finished parts, of logs with unfinished ones."""
        self._missing: dict[str, int] = {}
        self._jobs: dict[str, list[Piece]] = {}
        """The pieces that a future is about, by its key; one that looks for cuts has one."""

    def look(
        self, names: dict[str, str], known: dict[str, tuple[int, int] | Exception]
    ) -> list[Piece]:
        """Take over what was done before; the logs that are to do, in order."""
        self._logs = len(names)
        self._taken = self.manifest.taken() | set(names.values())
        todo = []
        for path, name in names.items():
            found = known[path]
            if isinstance(found, Exception):
                self._failed.append(Converted(path, name, error=in_words(found, path)))
            elif (row := self.manifest.done(path)) is not None:
                self.rows[path] = row
                self._done += 1
            else:
                self.rows[path] = Converted(path, name, *found)
                todo.append(Piece(path, name))
        return todo

    def begin(self, todo: list[Piece]) -> None:
        """Note what is to do, and what cannot be done."""
        self.manifest.begin({piece.path: piece.name for piece in todo})
        for row in self._failed:
            self._finish(row)

    def work(self, client: Any, todo: list[Piece]) -> None:
        """Convert everything. The manifest has each finished log, also after an error."""
        from distributed import as_completed

        pending = as_completed(self._begin_tasks(client, todo), loop=client.loop)
        for future in pending:
            pending.update(self._completed(client, future))

    def _begin_tasks(self, client: Any, todo: list[Piece]) -> list[Any]:
        sizes = {piece: self.rows[piece.path].size for piece in todo}
        large = {p for p in todo if may_be_cut(p.path, sizes[p], self.task_bytes)}
        small = [(piece, size) for piece, size in sizes.items() if piece not in large]
        workers = len(client.scheduler_info(n_workers=-1)["workers"]) or 1
        room = group_bytes(sum(size for _, size in small), workers, self.task_bytes)
        looking = [self._look_for_cuts(client, piece) for piece in todo if piece in large]
        return looking + [self._submit(client, group) for group in grouped(small, room)]

    def _look_for_cuts(self, client: Any, piece: Piece) -> Any:
        future = client.submit(
            find_cuts, piece.path, self.task_bytes, self.recipe.dialect, pure=False
        )
        self._jobs[future.key] = [piece]
        return future

    def _submit(self, client: Any, pieces: list[Piece]) -> Any:
        for piece in pieces:
            self._missing.setdefault(piece.path, 1)
        future = client.submit(convert_pieces, pieces, self.recipe, pure=False)
        self._jobs[future.key] = pieces
        return future

    def _completed(self, client: Any, future: Any) -> list[Any]:
        """Take over what a task found; the tasks that follow from it."""
        pieces = self._jobs.pop(future.key)
        if future.status == "cancelled":
            raise ConnectionError(
                "the scheduler is gone or has dropped the tasks: start again to go on"
            )
        looked = pieces[0].path not in self._missing
        if future.status != "error":
            found = future.result()
            if looked:
                return [self._submit(client, [p]) for p in self._cut(pieces[0], found)]
            for row in found:
                self._add(row)
            return []
        if looked:  # the conversion will say what is wrong
            return [self._submit(client, pieces)]
        if len(pieces) > 1:  # one of them may be what ends workers
            return [self._submit(client, [piece]) for piece in pieces]
        error = future.exception()
        self.manifest.remove_named(pieces[0].path, pieces[0].name)  # it may have ended halfway
        self._add(Converted(pieces[0].path, pieces[0].name, error=in_words(error, pieces[0].path)))
        return []

    def _cut(self, piece: Piece, ranges: list[Part]) -> list[Piece]:
        if not ranges:
            return [piece]
        self._missing[piece.path] = len(ranges)
        # Names of parts of an earlier run are used again.
        self._taken -= self.manifest.stems(piece.path) - {piece.name}
        names = [self._part_name(piece.name, number) for number in range(len(ranges))]
        return [Piece(piece.path, *part) for part in zip(names, ranges, strict=True)]

    def _part_name(self, name: str, number: int) -> str:
        mark = "+"
        while (part := f"{name}{mark}{number:04d}") in self._taken:
            mark += "+"
        self._taken.add(part)
        return part

    def _add(self, row: Converted) -> None:
        """A log or a part is done; when all parts are, the log is."""
        self.manifest.remove_files(row.stale)
        parts = self._parts.setdefault(row.path, [])
        parts.append(row)
        self._missing[row.path] -= 1
        if self._missing[row.path]:
            return
        del self._missing[row.path], self._parts[row.path]
        whole = self.rows[row.path]
        for part in parts:
            whole.rows += part.rows
            whole.bad_bytes += part.bad_bytes
            whole.unknown += part.unknown  # a log that has any is not cut
            whole.files.update(part.files)
            whole.error = whole.error or part.error
        if len(parts) > 1:
            whole.files = dict(sorted(whole.files.items()))
            if whole.error is not None:  # some of a log looks like all of it
                self.manifest.remove_files(whole.files)
                whole.files, whole.rows = {}, 0
        self._finish(whole)

    def _finish(self, row: Converted) -> None:
        """Note the outcome of a log."""
        self.rows[row.path] = row
        self.manifest.add(row)
        self._done += 1
        if self.progress is not None:
            self.progress(self._done, self._logs)
