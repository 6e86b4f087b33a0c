"""The security service of a run: it records what the guard decides, and shows it in its console."""

import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from rtron.demos.runtime.isolation import free_port
from rtron.demos.runtime.polling import wait_for
from rtron.demos.runtime.processes import ProcessGroup, StartedProcess
from rtron.errors import SourceError
from rtron.service.server.database_accounts import create_token_record, create_user_record
from rtron.service.server.database_setup import open_database
from rtron.workflows.service_client import SecurityServiceClient
from rtron.workflows.service_events import stored_events

Event = Mapping[str, Any]
"""An event as the service has it: `at` (wall ns), `kind`, `topic`, `flow`, `decision`, `reason`…"""
_SECOND = 1_000_000_000
_STORE_DELAY = 1.5
"""Seconds after which what the guard had to tell of a moment is stored: it tells once a second."""


@dataclass(frozen=True, slots=True)
class DecisionCounts:
    """How many messages of a flow met which decision."""

    passed: int = 0
    held: int = 0
    dropped: int = 0
    modified: int = 0

    def __add__(self, other: "DecisionCounts") -> "DecisionCounts":
        return DecisionCounts(
            self.passed + other.passed,
            self.held + other.held,
            self.dropped + other.dropped,
            self.modified + other.modified,
        )


@dataclass(frozen=True, slots=True)
class EventHistory:
    """The events of one robot's guard. The errors are those of the client.

    Times are ns of the wall clock; `until` is excluded, None is now.
    """

    client: SecurityServiceClient
    robot: str

    def robots(self) -> list[Mapping[str, Any]]:
        """Return the robots that the service knows, with the state of each one's guard."""
        found: list[Mapping[str, Any]] = self.client.get("robots")
        return found

    def state(self) -> Mapping[str, Any] | None:
        """Return what the guard told of itself last (a GuardState as JSON); None: nothing yet."""
        found: list[Mapping[str, Any] | None]
        found = [each["state"] for each in self.robots() if each["name"] == self.robot]
        return found[0] if found else None

    def wait_until_linked(self, since: int) -> None:
        """Wait until a guard that runs has told its state at `since` or later."""
        wait_for(
            lambda: self._last_state_time() >= since, "the guard to tell the service of itself"
        )

    def events(self, since: int, until: int | None = None, kind: str = "") -> list[Event]:
        """Return events in the order of time, once all of them are stored."""
        end = time.time_ns() if until is None else until
        self.wait_until_linked(end + int(_STORE_DELAY * _SECOND))
        found = stored_events(
            self.client, robot=self.robot, since=since, until=end, kind=kind or None
        )
        return sorted(found, key=lambda event: event["at"])

    def counts(self, since: int, until: int | None = None) -> dict[str, dict[str, DecisionCounts]]:
        """Return by topic and flow how many messages met which decision."""
        return sum_decision_counts(self.events(since, until, "counts"))

    def _last_state_time(self) -> int:
        state = self.state()
        return int(state["at"]) if state else 0


def sum_decision_counts(events: list[Event]) -> dict[str, dict[str, DecisionCounts]]:
    """Return the sums of `counts` events, by topic and flow."""
    found: dict[str, dict[str, DecisionCounts]] = {}
    for event in events:
        for topic, stream in event["values"]["streams"].items():
            flows = found.setdefault(topic, {})
            for flow, tally in stream["flows"].items():
                flows[flow] = flows.get(flow, DecisionCounts()) + DecisionCounts(*tally)
    return found


ROBOT = "tb3"
"""What the service calls the demo's robot."""
_ADMIN = "admin"
_ROLES = ("admin", "developer", "end_user")
_ACTOR = "rtron demo"
_GUARD, _DEVELOPER, _READ = _SCOPES = ("guard", "developer", "read")


@dataclass(frozen=True, slots=True, kw_only=True)
class DemoService:
    """A service that was started: its address, the admin's password, what it recorded."""

    url: str
    password: str
    guard_token: Path
    developer_token: Path
    history: EventHistory
    processes: ProcessGroup
    started: StartedProcess
    base_environ: Mapping[str, str]

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
        environ = {**self.base_environ, **self._environ(self.developer_token)}
        self.processes.run_command(_rtron_command("upload-graph", graph), environ, name="upload")

    def _environ(self, token: Path) -> dict[str, str]:
        return {"RTRON_ROBOT": ROBOT, "RTRON_SERVICE": self.url, "RTRON_TOKEN_FILE": str(token)}

    def _answers(self) -> bool:
        self.started.check()
        try:
            self.history.robots()
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
            guard_token=paths[_GUARD],
            developer_token=paths[_DEVELOPER],
            history=EventHistory(SecurityServiceClient(url, tokens[_READ]), ROBOT),
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
