"""A headless Chromium that tests drive over its DevTools socket."""

from __future__ import annotations

import base64
import contextlib
import os
import shutil
import subprocess
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from unit.bridge_tools import LIMIT
from unit.web_tools import WebSocketClient

NAMES = ("chromium", "chromium-browser", "google-chrome")


def executable() -> str | None:
    """The browser of this machine, if it has one."""
    return next((found for name in NAMES if (found := shutil.which(name))), None)


class Page:
    """A page that is open. `errors`: what its scripts threw and nobody caught."""

    def __init__(self, client: WebSocketClient) -> None:
        self._client = client
        self._count = 0
        self.errors: list[str] = []

    def call(self, method: str, **parameters: Any) -> Any:
        """A command of the DevTools protocol."""
        self._count += 1
        number = self._count
        self._client.send({"id": number, "method": method, "params": parameters})
        answer = self._client.until(lambda told: self._hear(told) == number and told)
        assert "error" not in answer, answer
        return answer["result"]

    def _hear(self, told: Any) -> int | None:
        """The number of the command that something answers; what is no answer may be an error of a script."""
        if told.get("method") == "Runtime.exceptionThrown":
            self.errors.append(told["params"]["exceptionDetails"]["exception"]["description"])
        return told.get("id")

    def run(self, script: str) -> Any:
        """The value of an expression in the page."""
        result = self.call(
            "Runtime.evaluate", expression=script, returnByValue=True, awaitPromise=True
        )
        assert "exceptionDetails" not in result, result
        return result["result"].get("value")

    def wait_for(self, script: str) -> Any:
        """Wait for an expression in the page to be true; its value."""
        end = time.monotonic() + LIMIT
        while not (value := self.run(script)):
            assert time.monotonic() < end, f"waited for {script}"
            time.sleep(0.05)
        return value

    def screenshot(self, path: Path) -> None:
        """The page as a PNG file."""
        path.write_bytes(base64.b64decode(self.call("Page.captureScreenshot")["data"]))


@contextmanager
def browse(url: str, folder: Path) -> Iterator[Page]:
    """A page at an address, in a browser whose files are in `folder`; its scripts must catch their errors."""
    command = executable()
    assert command is not None
    browser = subprocess.Popen(
        [command, "--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage",
         "--no-first-run", "--remote-debugging-port=0", "--window-size=1280,900",
         f"--user-data-dir={folder}", "about:blank"],
        stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, env={**os.environ, "HOME": str(folder)},
    )  # fmt: skip
    try:
        port_file = folder / "DevToolsActivePort"
        end = time.monotonic() + LIMIT
        while not (port_file.exists() and port_file.read_text().count("\n") == 1):
            if browser.poll() is not None or time.monotonic() > end:
                pytest.skip(f"{command} does not start here")
            time.sleep(0.05)
        port, path = port_file.read_text().split("\n")
        with WebSocketClient(int(port), path) as control:
            target = Page(control).call("Target.createTarget", url=url)["targetId"]
            with WebSocketClient(int(port), f"/devtools/page/{target}") as client:
                page = Page(client)
                page.call("Runtime.enable")  # tells errors, those of before too
                yield page
                page.run("null")  # what was thrown until now is told before the answer
                assert not page.errors, page.errors
    finally:
        browser.terminate()
        with contextlib.suppress(subprocess.TimeoutExpired):
            browser.wait(LIMIT)
        if browser.poll() is None:
            browser.kill()
            browser.wait()
