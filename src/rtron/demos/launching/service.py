"""The security service of a run: it records what the guard decides, and shows it in its console."""

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from rtron.demos.launching.domains import free_port
from rtron.demos.launching.processes import Processes, Started
from rtron.demos.launching.recorded import Recorded
from rtron.demos.launching.waiting import wait_for
from rtron.errors import SourceError

ROBOT = "tb3"
"""What the service calls the demo's robot."""
_ROLES = ("admin", "developer", "end_user")
_NOTHING: Mapping[str, str] = {}


@dataclass(frozen=True, slots=True, kw_only=True)
class Service:
    """A running service: its address, the admin's password for the console, what it recorded."""

    url: str
    password: str
    guard_token: Path
    developer_token: Path
    recorded: Recorded
    rtron: "Rtron"

    @property
    def page(self) -> str:
        """The address of the console's page with what the guard decided."""
        return f"{self.url}/#/robots/{ROBOT}/events"

    def environ(self) -> dict[str, str]:
        """Return what leads a guard to the service."""
        return self._environ(self.guard_token)

    def upload(self, graph: Path) -> None:
        """Let the console show the whole app that is guarded now, and all risks.

        To be called once its guard has told of itself; SourceError if the service refuses.
        """
        self.rtron.finish("upload", graph, environ=self._environ(self.developer_token))

    def _environ(self, token: Path) -> dict[str, str]:
        return {
            "RTRON_ROBOT": ROBOT,
            "RTRON_SERVICE": self.url,
            "RTRON_TOKEN_FILE": str(token),
        }


@contextmanager
def served(processes: Processes, folder: Path, environ: dict[str, str]) -> Iterator[Service]:
    """Run the service on this machine until the end of the block, all its files in `folder`.

    It runs in the Python of the caller. InputError or SourceError if it cannot be run.
    """
    folder.mkdir(mode=0o700)
    rtron = Rtron(processes, environ | {"RTRON_DATABASE": str(folder / "rtron.db")})
    password = folder / "admin.password"
    roles = [word for role in _ROLES for word in ("--role", role)]
    rtron.finish("user", "add", "admin", *roles, "--password-file", password)
    guard = rtron.token(folder, "guard", "--robot", ROBOT)
    developer = rtron.token(folder, "developer")
    reader = rtron.token(folder, "read")
    port = free_port()
    with rtron.serving(port) as started:
        recorded = Recorded(f"http://127.0.0.1:{port}", reader.read_text().strip(), ROBOT)
        _wait(started, recorded)
        yield Service(
            url=recorded.url,
            password=password.read_text().strip(),
            guard_token=guard,
            developer_token=developer,
            recorded=recorded,
            rtron=rtron,
        )


@dataclass(frozen=True, slots=True)
class Rtron:
    """The commands of RTron that work on one database."""

    processes: Processes
    environ: dict[str, str]

    def finish(self, *words: str | Path, environ: Mapping[str, str] = _NOTHING) -> None:
        """Run a command to its end; SourceError if it fails."""
        command = self._command(*words)
        self.processes.finish(command, {**self.environ, **environ}, name=str(words[0]))

    def token(self, folder: Path, scope: str, *words: str) -> Path:
        """Make a token; return the file in the folder that it is in."""
        path = folder / f"{scope}.token"
        self.finish("token", "create", scope, "--scope", scope, *words, "--token-file", path)
        return path

    @contextmanager
    def serving(self, port: int) -> Iterator[Started]:
        """Run the service until the end of the block."""
        command = self._command("serve", "--port", str(port))
        with self.processes.running(command, self.environ, name="serve") as started:
            yield started

    def _command(self, *words: str | Path) -> list[str | Path]:
        return [sys.executable, "-m", "rtron", *words]


def _wait(started: Started, recorded: Recorded) -> None:
    def is_ready() -> bool:
        started.check()
        try:
            recorded.robots()
        except SourceError:
            return False
        return True

    wait_for(is_ready, "the security service")
