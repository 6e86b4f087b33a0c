"""The security service as its user runs it: a process, its database, tokens and requests."""

import json
import re
import signal
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeVar
from urllib.error import HTTPError, URLError
from urllib.request import Request, urlopen

from typing_extensions import Self

from rtron.cli.commands.token import TokenScope, create
from rtron.demos.runtime.isolation import free_port

T = TypeVar("T")
_PASSWORD = re.compile(r"with the password (\S+)\n")
_START_S = 120.0
_CALL_S = 30.0
_PAUSE_S = 0.02


class ServiceProcess:
    """`rtron serve` on a port of its own; it can be killed and started again on the same data."""

    def __init__(
        self,
        folder: Path,
        database: str | Path = "",
        *more: str,
        idle: bool = False,
        token_name: str = "measuring",
    ) -> None:
        self.folder = folder
        self.database = str(database or folder / "service.sqlite")
        self.port = free_port()
        self.password = ""
        self._more = more
        self._token_name = token_name
        self._idle = idle
        self._process: subprocess.Popen[bytes] | None = None
        self._starts = 0
        self._token = ""

    def __enter__(self) -> Self:
        scopes = "read", "developer", "end_user", "admin"
        try:
            self.start()
            self._token = self.create_token(self._token_name, *scopes).read_text()
        except BaseException:
            self.stop()
            raise
        return self

    def __exit__(self, *_: object) -> None:
        self.stop()

    @property
    def url(self) -> str:
        """The address of the service."""
        return f"http://127.0.0.1:{self.port}"

    @property
    def pid(self) -> int:
        """The process."""
        return self._process.pid if self._process else 0

    def start(self) -> None:
        """Start it, and wait until it is ready."""
        self._starts += 1
        is_new = "://" not in self.database and not Path(self.database).exists()
        log = self.folder / f"serve{self._starts}.log"
        arguments = ["serve", "--database", self.database, "--port", str(self.port)]
        with log.open("wb") as output:
            self._process = subprocess.Popen(
                [
                    "chrt",
                    "--idle" if self._idle else "--other",
                    "0",
                    *rtron_command(*arguments, *self._more),
                ],
                stdout=output,
                stderr=subprocess.STDOUT,
            )
        _wait(lambda: self._is_ready(log), f"the service: {log}")
        if is_new:
            found = _wait(lambda: _PASSWORD.search(log.read_text()), "the first password")
            self.password = found[1]

    def stop(self, number: signal.Signals = signal.SIGTERM) -> None:
        """End it; SIGKILL ends it without a word."""
        if self._process:
            self._process.send_signal(number)
            try:
                self._process.wait(10)
            except subprocess.TimeoutExpired:
                self._process.kill()
                self._process.wait()

    def create_token(self, name: str, *scopes: str, robot: str = "") -> Path:
        """Make a token and return the file that it stands in."""
        path, scope = self.folder / f"{name}.token", [TokenScope(each) for each in scopes]
        create(name, scope=scope, robot=robot or None, token_file=path, database=self.database)
        return path

    def request(self, path: str, method: str = "GET", body: object = None, token: str = "") -> Any:  # noqa: ANN401
        """Return what the API answers, as JSON; HTTPError if it is no."""
        request = Request(f"{self.url}{path}", method=method)
        request.add_header("Authorization", f"Bearer {(token or self._token).strip()}")
        if body is not None:
            request.data = json.dumps(body).encode()
            request.add_header("Content-Type", "application/json")
        with urlopen(request, timeout=_CALL_S) as answer:
            text = answer.read()
        return json.loads(text) if text else None

    def change(self, robot: str, nodes: object, reason: str = "a test") -> Any:  # noqa: ANN401
        """Change settings on top of the newest; return the new ones."""
        newest = self.request(f"/api/v1/robots/{robot}/settings")["revision"]
        body = {"revision": newest, "nodes": nodes, "reason": reason}
        return self.request(f"/api/v1/robots/{robot}/settings", "PATCH", body)

    def state(self, robot: str) -> Any:  # noqa: ANN401
        """Return what is so now on a robot; None while nobody knows."""
        try:
            found = self.request(f"/api/v1/robots/{robot}")
        except HTTPError as error:
            error.close()
            return None
        return found

    def _is_ready(self, log: Path) -> bool:
        if self._process and self._process.poll() is not None:
            raise RuntimeError(log.read_text())
        try:
            with urlopen(f"{self.url}/readyz", timeout=_CALL_S):
                return True
        except (URLError, OSError):
            return False


def rtron_command(*arguments: str) -> list[str]:
    """Return the command line of this Python's `rtron_command`."""
    return [sys.executable, "-m", "rtron", *arguments]


def _wait(condition: Callable[[], T], what: str) -> T:
    deadline = time.monotonic() + _START_S
    while not (found := condition()):
        if time.monotonic() > deadline:
            raise TimeoutError(what)
        time.sleep(_PAUSE_S)
    return found
