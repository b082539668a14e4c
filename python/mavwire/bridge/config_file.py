"""Configuration files: TOML, or the format of mavlink-router's main.conf. No file is executed."""

from __future__ import annotations

import os
import re
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from mavwire.dialects import UPSTREAM

from .checks import only_known, seconds, text
from .endpoints import parse_endpoint
from .errors import ConfigError
from .options import Config, Recording, Settings
from .sidecars import Listen, SinkOptions, listen_from, sink_from

# No configuration is longer; a path that leads to something else by mistake is not read whole.
MAX_SIZE = 1 << 20


def load_config(path: str | os.PathLike[str]) -> Config:
    """Read a file: TOML if its name ends so, else mavlink-router's format.

    ConfigError (a ValueError) names the file and what is wrong in it; OSError if it cannot be read.
    """
    name = os.fspath(path)
    with open(name, "rb") as file:
        data = file.read(MAX_SIZE + 1)
    if len(data) > MAX_SIZE:
        raise ConfigError(f"{name}: longer than {MAX_SIZE} bytes")
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ConfigError(f"{name}: not text, at byte {error.start}") from None
    if name.lower().endswith(".toml"):
        return _Toml(name, text).config()
    from .main_conf import parse_main_conf

    return parse_main_conf(name, text)


class _Toml:
    """A TOML file that is read. Errors name the file, the table and the option."""

    def __init__(self, name: str, text: str) -> None:
        self._name = name
        self._content = _content(name, text)

    def config(self) -> Config:
        content, config = self._content, Config(path=self._name)
        known = (
            "dedup", "max_age", "sniffer_sysid", "dialect", "record", "json", "http", "metrics",
            "sink", "link",
        )  # fmt: skip
        try:
            only_known(content, known)
            for option in ("dedup", "max_age", "sniffer_sysid"):
                if option in content:
                    config.settings[option] = content[option]
            Settings(**config.settings)
            dialect = content.get("dialect", UPSTREAM)
            names = dialect if isinstance(dialect, list) else [dialect]
            config.dialect = [text("dialect", name) for name in names]
            if "json" in content:
                config.json = seconds("json", content["json"], least=1e-3)
            for option in ("link", "sink"):
                if not isinstance(content.get(option, []), list):
                    raise ConfigError(f"say [[{option}]], not [{option}]")
        except ConfigError as error:
            raise error.at(self._name) from None
        if "record" in content:
            config.recording = self._recording(content["record"])
        config.http = self._listen("http")
        config.metrics = self._listen("metrics")
        config.sinks = [self._sink(*item) for item in enumerate(content.get("sink", []))]
        for number, link in enumerate(content.get("link", [])):
            self._add(config, number, link)
        return config

    @contextmanager
    def _named(self, title: str) -> Iterator[None]:
        """Errors inside begin with the name of the file and a title."""
        try:
            yield
        except ConfigError as error:
            raise error.at(f"{self._name}: {title}") from None

    def _recording(self, record: Any) -> Recording:
        with self._named("record"):
            if not isinstance(record, dict) or "directory" not in record:
                raise ConfigError("it needs a directory")
            only_known(record, ("directory", "max_bytes", "max_age", "flush_interval"))
            return Recording(**record)

    def _listen(self, name: str) -> Listen | None:
        if name not in self._content:
            return None
        with self._named(name):
            return listen_from(self._content[name], f"{self._name}: {name}")

    def _sink(self, number: int, table: Any) -> SinkOptions:
        title = f"sink {number + 1}"
        with self._named(title):
            return sink_from(table, f"{self._name}: {title}")

    def _add(self, config: Config, number: int, link: Any) -> None:
        title = f"link {number + 1}"
        if not isinstance(link, dict) or "endpoint" not in link:
            reason = "it needs an endpoint, such as 'udpin:0.0.0.0:14550'"
            raise ConfigError(f"{self._name}: {title}: {reason}")
        options = {key: value for key, value in link.items() if key != "endpoint"}
        if isinstance(options.get("name"), str):
            title += f" ({options['name']!r})"
        with self._named(title):
            endpoint = parse_endpoint(text("endpoint", link["endpoint"]))
        config.links.append((f"{self._name}: {title}", endpoint, options))


def _line(error: ValueError, text: str) -> int:
    """Where a text is no TOML: what `tomllib` says, or the last line, where it only says that the text ended."""
    told = re.search(r"\(at line (\d+), ", str(error))
    return int(told[1]) if told else text.rstrip().count("\n") + 1


def _content(name: str, text: str) -> dict[str, Any]:
    import tomllib

    try:
        return tomllib.loads(text)
    except RecursionError:
        raise ConfigError(f"{name}: nested too deeply") from None
    except tomllib.TOMLDecodeError as error:
        raise ConfigError(f"{name}:{_line(error, text)}: {error}") from None
    except ValueError:  # what int() says is nothing that a user can act upon
        raise ConfigError(f"{name}: a number has thousands of digits") from None
