"""The security service of a run: it records what the guard decides, and shows it in its console."""

import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path

from rtron.demos.runtime.event_history import Recorded
from rtron.demos.runtime.isolation import free_port
from rtron.demos.runtime.polling import wait_for
from rtron.demos.runtime.processes import Processes, Started
from rtron.errors import SourceError
from rtron.service.server.database_setup import open_database
from rtron.service.server.offline_accounts import make_token, make_user

ROBOT = "tb3"
"""What the service calls the demo's robot."""
_ADMIN = "admin"
_ROLES = ("admin", "developer", "end_user")
_WHO = "rtron demo"
_GUARD, _DEVELOPER, _READ = _SCOPES = ("guard", "developer", "read")


@dataclass(frozen=True, slots=True, kw_only=True)
class Service:
    """A service that was started: its address, the admin's password, what it recorded."""

    url: str
    password: str
    guard_token: Path
    developer_token: Path
    recorded: Recorded
    processes: Processes
    started: Started
    around: Mapping[str, str]

    @property
    def page(self) -> str:
        """The address of the console's page with what the guard decided."""
        return f"{self.url}/#/robots/{ROBOT}/events"

    def environ(self) -> dict[str, str]:
        """Return what leads a guard to the service."""
        return self._environ(self.guard_token)

    def wait(self) -> None:
        """Wait until the service answers; SourceError if it has ended."""
        wait_for(self._answers, "the security service")

    def upload(self, graph: Path) -> None:
        """Let the console show the whole app that is guarded now, and all risks.

        To be called once its guard has told of itself; SourceError if the service refuses.
        """
        environ = {**self.around, **self._environ(self.developer_token)}
        self.processes.finish(_command("upload", graph), environ, name="upload")

    def _environ(self, token: Path) -> dict[str, str]:
        return {
            "RTRON_ROBOT": ROBOT,
            "RTRON_SERVICE": self.url,
            "RTRON_TOKEN_FILE": str(token),
        }

    def _answers(self) -> bool:
        self.started.check()
        try:
            self.recorded.robots()
        except SourceError:
            return False
        return True


@contextmanager
def served(processes: Processes, folder: Path, environ: Mapping[str, str]) -> Iterator[Service]:
    """Start the service on this machine, which runs until the end of the block.

    All its files are in `folder`; it runs in the Python of the caller.
    """
    folder.mkdir(mode=0o700)
    database, port = folder / "rtron.db", free_port()
    password, tokens = _accounts(database)
    paths = {scope: _kept(folder / f"{scope}.token", tokens[scope]) for scope in _SCOPES}
    around = {**environ, "RTRON_DATABASE": str(database)}
    with processes.running(_command("serve", "--port", str(port)), around, name="serve") as started:
        url = f"http://127.0.0.1:{port}"
        yield Service(
            url=url,
            password=password,
            guard_token=paths[_GUARD],
            developer_token=paths[_DEVELOPER],
            recorded=Recorded(url, tokens[_READ], ROBOT),
            processes=processes,
            started=started,
            around=around,
        )


def _accounts(path: Path) -> tuple[str, Mapping[str, str]]:
    """Make the database with an admin; return the password, and a token for each scope."""
    with closing(open_database(str(path))) as database:
        password = make_user(database, _WHO, _ADMIN, _ROLES)
        return password, {scope: make_token(database, _WHO, _wanted(scope)) for scope in _SCOPES}


def _wanted(scope: str) -> Mapping[str, object]:
    return {"name": scope, "scopes": [scope], "robot": ROBOT if scope == _GUARD else None}


def _kept(path: Path, secret: str) -> Path:
    path.touch(mode=0o600)
    path.write_text(secret, encoding="utf-8")
    return path


def _command(*words: str | Path) -> Sequence[str | Path]:
    return [sys.executable, "-m", "rtron", *words]
