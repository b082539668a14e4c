"""Run the snippets of a page of the documentation, in order, in the current folder.

    python doc_page.py ../docs/tutorial.md

What is run, by the language of the fence:

python          in one namespace for the page; a block whose first line is `# name.py` is saved under that name
sh              each line must end with exit code 0
console         lines after `$ ` are commands; what follows is their output, in which `...` is anything
toml, xml, ...  saved, if the first line is a comment with a file name; else only shown

Comments in the page, which readers do not see, say what differs:

<!-- setup ... -->           Python that makes what the page takes for granted; `page` is an
                             ExitStack, `page_text` what comes behind the first setup
<!-- run: background -->     the next block goes on until the page ends
<!-- run: until output -->   the next block is stopped by Ctrl-C once it has printed something
<!-- run: not, because -->   the next block is only compiled, if it is Python, and otherwise left alone

Ports that pages name are replaced by free ones, and simulated vehicles are hastened.
"""

from __future__ import annotations

import os
import re
import signal
import socket
import subprocess
import sys
import threading
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import dataclass
from pathlib import Path
from typing import Any

BLOCK = re.compile(
    r"^<!-- setup\n(?P<setup>.*?)^-->$"
    r"|^(?:<!-- run: (?P<how>[^\n]*?) -->\n+)?```(?P<language>\w+)\n(?P<code>.*?)^```$",
    re.MULTILINE | re.DOTALL,
)
FILE = re.compile(r"(?:# |<!-- )([\w./-]+\.\w+)(?: -->)?\n")
PORTS = ("14550", "14551", "14552", "14560", "5760", "5600", "8080", "9090")
LANGUAGES = {"python", "sh", "console"}
WAIT = 120.0  # seconds
SPEED = 8
VEHICLE = "udpout:127.0.0.1:14550"


@dataclass
class Block:
    """A fenced block, or the setup of a page."""

    language: str
    code: str
    how: str
    line: int


def blocks(text: str) -> Iterator[Block]:
    """All blocks of a page, in order."""
    for match in BLOCK.finditer(text):
        setup = match["setup"]
        code = match["code"] if setup is None else setup
        start = match.start("code" if setup is None else "setup")
        yield Block(
            match["language"] or "python", code, match["how"] or "", text.count("\n", 0, start)
        )


def free_ports() -> dict[str, str]:
    """For each port that a page may name, one that is free for UDP and TCP."""
    found: dict[str, str] = {}
    with ExitStack() as held:
        while len(found) < len(PORTS):
            stream = held.enter_context(socket.socket(socket.AF_INET, socket.SOCK_STREAM))
            datagrams = held.enter_context(socket.socket(socket.AF_INET, socket.SOCK_DGRAM))
            stream.bind(("127.0.0.1", 0))
            try:
                datagrams.bind(stream.getsockname())
            except OSError:
                continue
            found[PORTS[len(found)]] = str(stream.getsockname()[1])
    return found


def adapted(text: str, ports: dict[str, str]) -> str:
    """A page's text with the ports of this run, and with vehicles that are quick and stay armed."""
    text = re.sub(r"(?<=mavwire sim)\b(?![^\n]*--out)", f" --out {VEHICLE}", text)
    text = re.sub(r"(?<=mavwire sim)\b(?![^\n]*--autopilot)", " --param DISARM_DELAY=0", text)
    text = re.sub(r"(?<=mavwire sim)\b", f" --speed {SPEED} --quiet", text)
    return re.sub(rf"\b({'|'.join(PORTS)})\b", lambda match: ports[match[1]], text)


class Page:
    """The state of a run: one namespace, and what goes on in the background."""

    def __init__(self, name: str, text: str) -> None:
        self.name = name
        self.stack = ExitStack()
        self.names: dict[str, Any] = {
            "__name__": "__main__", "page": self.stack, "page_text": text,
        }  # fmt: skip
        self.background: list[subprocess.Popen[bytes]] = []

    def run(self, block: Block) -> None:
        """One block; an exception says what was wrong with it."""
        saved = FILE.match(block.code)
        if block.how.startswith("not,"):
            if block.language == "python":
                self.compiled(block)
        elif block.language == "python" and not saved:
            self.python(block)
        elif block.language == "sh":
            self.shell(block)
        elif block.language == "console":
            self.console(block)
        elif saved:
            Path(saved[1]).write_text(block.code, encoding="utf-8")

    def compiled(self, block: Block) -> Any:
        """Its code, with the lines of the page; a coroutine where it awaits."""
        import ast

        flags = ast.PyCF_ALLOW_TOP_LEVEL_AWAIT
        return compile("\n" * block.line + block.code, self.name, "exec", flags=flags)

    def python(self, block: Block) -> None:
        """Run it in the page's namespace."""
        if block.how == "until output":
            self.until_output([sys.executable, "-c", block.code])
        else:
            exec(self.compiled(block), self.names)

    def shell(self, block: Block) -> None:
        """Run all of it; the first line that fails ends it."""
        if block.how == "background":
            self.background.append(start(["bash", "-ec", block.code]))
        elif block.how == "until output":
            self.until_output(["bash", "-ec", f"exec {block.code.strip()}"])
        else:
            subprocess.run(["bash", "-ec", block.code], check=True, timeout=WAIT)

    def console(self, block: Block) -> None:
        """Run each command and compare what it prints."""
        for command, expected in commands(block.code):
            if block.how == "background":
                self.background.append(start(["bash", "-c", f"exec {command}"]))
                continue
            made = subprocess.run(
                ["bash", "-c", command], capture_output=True, text=True, check=False, timeout=WAIT
            )
            printed = made.stdout + made.stderr
            if not agrees(printed, expected):
                raise AssertionError(f"$ {command}\nprinted\n{printed}\nand not\n{expected}")

    def until_output(self, command: list[str]) -> None:
        """Run it, wait for its first line, press Ctrl-C."""
        process = start(command, stdout=subprocess.PIPE)
        timer = threading.Timer(WAIT, process.kill)
        timer.start()
        try:
            assert process.stdout
            if not process.stdout.readline():
                raise AssertionError(
                    f"{command[-1]}: ended with {process.wait()} and printed nothing"
                )
            process.send_signal(signal.SIGINT)
            process.stdout.read()
        finally:
            timer.cancel()
            process.kill()
            process.wait()

    def close(self) -> None:
        """Stop what goes on."""
        self.stack.close()
        for process in self.background:
            process.send_signal(signal.SIGINT)
        for process in self.background:
            try:
                process.wait(WAIT)
            finally:
                process.kill()


def start(command: list[str], **options: Any) -> subprocess.Popen[bytes]:
    """A process that runs beside the page."""
    return subprocess.Popen(command, stdin=subprocess.DEVNULL, **options)


def commands(code: str) -> Iterator[tuple[str, str]]:
    """Each command of a console block with the output that is shown for it."""
    for part in re.split(r"^\$ ", code, flags=re.MULTILINE)[1:]:
        command, _, expected = part.partition("\n")
        while command.endswith("\\"):
            more, _, expected = expected.partition("\n")
            command = command[:-1] + more
        yield command, expected


def agrees(printed: str, expected: str) -> bool:
    """Whether the output is as shown: `...` stands for anything, runs of blanks are alike."""
    parts = [re.escape(" ".join(part.split())) for part in expected.split("...")]
    pattern = r".*".join(part.replace(r"\ ", " ?") for part in parts)
    return re.fullmatch(pattern, " ".join(printed.split()), re.DOTALL) is not None


def main() -> int:
    """0; an exception ends the page at the block where something was wrong."""
    path = Path(sys.argv[1])
    bin_folder = str(Path(sys.executable).parent)
    os.environ["PATH"] = os.pathsep.join([bin_folder, os.environ["PATH"]])
    os.environ["PYTHONUNBUFFERED"] = "1"
    text = adapted(path.read_text(encoding="utf-8"), free_ports())
    page = Page(path.name, text.partition("\n-->\n")[2] or text)
    try:
        for block in blocks(text):
            page.run(block)
    except BaseException:
        print(f"{path.name}:{block.line}: this block went wrong", file=sys.stderr)
        raise
    finally:
        page.close()
    return 0


if __name__ == "__main__":
    sys.exit(main())
