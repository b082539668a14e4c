"""`mavwire sql "select max(alt) from VFR_HUD" LOG...`: ask logs in SQL; DuckDB answers.

Each message type is a table, whose column `log` has the name of the file. A query may name logs itself,
in double quotes: `select count(*) from "logs/*.tlog".ATTITUDE`. Needs pip install 'mavwire[data]'.
"""

from __future__ import annotations

import argparse
import csv
import glob
import json
import os
import sys
import tempfile
from collections.abc import Iterator
from typing import Any

from mavwire._extras import extra
from mavwire._text import in_words
from mavwire.cli._errors import CommandError, refused, tell
from mavwire.cli._progress import Progress
from mavwire.cli.logs._query_arguments import add_values, values_of

FILES = {".parquet": "format parquet", ".csv": "format csv, header", ".jsonl": "format json"}
FETCHED = 10_000
"""Rows of a result that are held at a time."""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    parser.add_argument("query", metavar="QUERY", help="a SELECT; - reads it from standard input")
    parser.add_argument("logs", metavar="LOG", nargs="*", help="telemetry or dataflash log")
    parser.add_argument("-o", "--out", metavar="FILE", help=f"a file: {', '.join(FILES)}")
    parser.add_argument(
        "--format",
        choices=["table", "csv", "jsonl"],
        help="of what is printed (default: table on a terminal, else csv)",
    )
    add_values(parser)


def main(args: argparse.Namespace) -> int:
    """Run the subcommand; 1 where a log could not be read."""
    with refused(ImportError), extra("data"):
        import duckdb
        import pyarrow  # noqa: F401, since DuckDB takes streams with it
    suffix = os.path.splitext(args.out or "")[1]
    if args.out and suffix not in FILES:
        raise CommandError(f"--out {args.out}: the name must end in {', '.join(FILES)}")
    query = (sys.stdin.read() if args.query == "-" else args.query).strip().rstrip(";")
    with (
        tempfile.TemporaryDirectory() as spilled,
        duckdb.connect(config={"temp_directory": spilled}) as database,
    ):
        try:
            failed = _load(database, query, args)
            if args.out:
                name = args.out.replace("'", "''")
                database.execute(f"copy ({query}) to '{name}' ({FILES[suffix]})")
            else:
                _print(database, query, args.format)
        except duckdb.Error as error:
            text, *_ = str(error).split("\n\nLINE")  # which the shell shows
            raise CommandError(text.replace("\n", " ")) from error
    return int(failed)


def _load(database: Any, query: str, args: argparse.Namespace) -> bool:
    """Make the tables of messages that a query names; whether a log could not be read."""
    from mavwire.logs.reading import paths_of, scan

    options = {**values_of(args), "unknown": "ignore"}
    failed = False
    with Progress("") as bar:
        for table, (paths, name) in _tables(database, query, paths_of(args.logs)).items():
            is_made = False
            for number, path in enumerate(paths):
                bar.update(100 * number / len(paths), f"{name} of {path}")
                try:
                    _add(database, table, path, scan(path, name, **options))
                    is_made = True
                except (OSError, ValueError) as error:
                    failed = True
                    tell(f"mavwire sql: {path}: {in_words(error, path)}")
            if not is_made:
                raise CommandError(f"{name} could be read from none of the logs")
    return failed


def _tables(database: Any, query: str, logs: list[str]) -> dict[str, tuple[list[str], str]]:
    """The tables of messages that a query names, by their names in SQL: logs and message type."""
    [(text,)] = database.execute("select json_serialize_sql(?::varchar)", [query]).fetchall()
    parsed = json.loads(text)
    if parsed["error"]:
        raise CommandError(parsed["error_message"])
    if len(parsed["statements"]) > 1:
        raise CommandError("one SELECT at a time")
    nodes = list(_nodes(parsed))
    made = {node["key"].upper() for node in nodes if "key" in node}  # by WITH
    tables = {}
    for node in (one for one in nodes if one.get("type") == "BASE_TABLE"):
        pattern, name = node["schema_name"], node["table_name"].upper()
        if pattern and (paths := sorted(glob.glob(pattern))):
            schema = _quoted(pattern)
            database.execute(f"create schema if not exists {schema}")
            tables[f"{schema}.{_quoted(name)}"] = paths, name
        elif not pattern and name.isidentifier() and name not in made:
            if not logs:
                raise CommandError(f"name logs behind the query: {name} is a table of them")
            tables[name] = logs, name
    return tables


def _quoted(name: str) -> str:
    """A name as SQL writes it."""
    return '"' + name.replace('"', '""') + '"'


def _nodes(tree: Any) -> Iterator[dict[str, Any]]:
    """The objects in a text of JSON."""
    if isinstance(tree, dict):
        yield tree
        tree = list(tree.values())
    if isinstance(tree, list):
        for one in tree:
            yield from _nodes(one)


def _add(database: Any, table: str, path: str, stream: Any) -> None:
    """Add the rows of a log to a table. It gets the columns that it lacks."""
    database.register("stream", stream)
    database.execute(f"create table if not exists {table} (log varchar)")
    for name, kind, *_ in database.execute("describe select * from stream").fetchall():
        database.execute(f"alter table {table} add column if not exists {_quoted(name)} {kind}")
    database.execute(f"insert into {table} by name select ? as log, * from stream", [path])


def _print(database: Any, query: str, form: str | None) -> None:
    """Print the rows of a query."""
    if form == "table" or (form is None and sys.stdout.isatty()):
        print(database.sql(query))
        return
    result = database.execute(query)
    names = [column[0] for column in result.description]
    writer = csv.writer(sys.stdout, lineterminator="\n")
    if form != "jsonl":
        writer.writerow(names)
    while rows := result.fetchmany(FETCHED):
        if form != "jsonl":
            writer.writerows(rows)
            continue
        for row in rows:
            print(json.dumps(dict(zip(names, row, strict=True)), default=str))
