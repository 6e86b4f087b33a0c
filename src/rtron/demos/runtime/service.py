"""The security service of a run: it records what the guard decides, and shows it in its console."""

import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rtron.demos.metrics.case_run import SECOND, Event
from rtron.demos.runtime.isolation import free_port
from rtron.demos.runtime.polling import wait_for
from rtron.demos.runtime.processes import ProcessGroup, StartedProcess
from rtron.errors import SourceError
from rtron.service.server.database_accounts import create_token_record, create_user_record
from rtron.service.server.database_setup import open_database
from rtron.workflows.service_client import SecurityServiceClient
from rtron.workflows.service_events import stored_events

_STORE_DELAY = 1.5
"""Seconds after which what the guard had to tell of a moment is stored: it tells once a second."""


ROBOT = "tb3"
"""What the service calls the demo's robot."""
_ADMIN = "admin"
_ROLES = ("admin", "developer", "end_user")
_ACTOR = "rtron demo"
_GUARD, _DEVELOPER, _READ = _SCOPES = ("guard", "developer", "read")


@dataclass(frozen=True, slots=True, kw_only=True)
class DemoService:
    """A service that was started: its address, the admin's password, the files of its tokens.

    The errors of what asks it are those of its client.
    """

    url: str
    password: str
    tokens: Mapping[str, Path]
    client: SecurityServiceClient
    processes: ProcessGroup
    started: StartedProcess
    base_environ: Mapping[str, str]

    @property
    def page(self) -> str:
        """The address of the console's page with what the guard decided."""
        return f"{self.url}/#/robots/{ROBOT}/events"

    def environ(self) -> dict[str, str]:
        """Return what leads a guard to the service."""
        return self._environ(_GUARD)

    def wait(self) -> None:
        """Wait until the service answers; SourceError if it has ended."""
        wait_for(self._answers, "the security service")

    def upload(self, graph: Path) -> None:
        """Let the console show the whole app that is guarded now, and all risks.

        To be called once its guard has told of itself; SourceError if the service refuses.
        """
        environ = {**self.base_environ, **self._environ(_DEVELOPER)}
        self.processes.run_command(_rtron_command("upload-graph", graph), environ, name="upload")

    def wait_until_linked(self, since: int) -> None:
        """Wait until a guard that runs has told its state at `since` (wall ns) or later."""
        wait_for(
            lambda: self._last_state_time() >= since, "the guard to tell the service of itself"
        )

    def events(self, since: int, until: int) -> list[Event]:
        """Return the events from `since` until before `until` (wall ns), once all are stored."""
        self.wait_until_linked(until + int(_STORE_DELAY * SECOND))
        found = stored_events(self.client, robot=ROBOT, since=since, until=until)
        return sorted(found, key=lambda event: event["at"])

    def _environ(self, scope: str) -> dict[str, str]:
        token = str(self.tokens[scope])
        return {"RTRON_ROBOT": ROBOT, "RTRON_SERVICE": self.url, "RTRON_TOKEN_FILE": token}

    def _last_state_time(self) -> int:
        states = [each["state"] for each in self._robots() if each["name"] == ROBOT]
        return max((int(state["at"]) for state in states if state), default=0)

    def _robots(self) -> list[Mapping[str, Any]]:
        found: list[Mapping[str, Any]] = self.client.get("robots")
        return found

    def _answers(self) -> bool:
        self.started.check()
        try:
            self._robots()
        except SourceError:
            return False
        return True


@contextmanager
def run_service(
    processes: ProcessGroup, folder: Path, environ: Mapping[str, str]
) -> Iterator[DemoService]:
    """Start the service on this machine, which runs until the end of the block.

    All its files are in `folder`; it runs in the Python of the caller.
    """
    folder.mkdir(mode=0o700)
    database, port = folder / "rtron.db", free_port()
    password, tokens = _create_accounts(database)
    paths = {
        scope: _write_private_file(folder / f"{scope}.token", tokens[scope]) for scope in _SCOPES
    }
    base_environ = {**environ, "RTRON_DATABASE": str(database)}
    with processes.running(
        _rtron_command("serve", "--port", str(port)), base_environ, name="serve"
    ) as started:
        url = f"http://127.0.0.1:{port}"
        yield DemoService(
            url=url,
            password=password,
            tokens=paths,
            client=SecurityServiceClient(url, tokens[_READ]),
            processes=processes,
            started=started,
            base_environ=base_environ,
        )


def _create_accounts(path: Path) -> tuple[str, Mapping[str, str]]:
    """Make the database with an admin; return the password, and a token for each scope."""
    with closing(open_database(str(path))) as database:
        password = create_user_record(database, _ACTOR, _ADMIN, _ROLES)
        return password, {
            scope: create_token_record(database, _ACTOR, _token_request(scope)) for scope in _SCOPES
        }


def _token_request(scope: str) -> Mapping[str, object]:
    return {"name": scope, "scopes": [scope], "robot": ROBOT if scope == _GUARD else None}


def _write_private_file(path: Path, secret: str) -> Path:
    path.touch(mode=0o600)
    path.write_text(secret, encoding="utf-8")
    return path


def _rtron_command(*arguments: str | Path) -> Sequence[str | Path]:
    return [sys.executable, "-m", "rtron", *arguments]
