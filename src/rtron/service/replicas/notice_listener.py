"""The notices of other replicas: PostgreSQL's LISTEN, on a connection of its own.

As long as that connection lives, so does the replica for the others. Where it was cut, what was
told meanwhile is lost, so with each new one everything is read again.
"""

import logging
import time
from collections import deque
from collections.abc import Callable, Sequence
from select import select
from threading import Event, Thread
from typing import Any

from sqlalchemy import Connection
from sqlalchemy.exc import SQLAlchemyError

from rtron.service.store.database import Database
from rtron.service.store.live_guards import lock_replica
from rtron.service.store.notices import (
    Notice,
    parse_notice,
)

log = logging.getLogger(__name__)
CUT_OFF_S = 3.0
"""So long without a connection, and others know better than this replica, s."""
_TICK_S = 0.25
_ANSWER_TIMEOUT_S = 2.0
_RETRY_S = 0.1


class NoticeListener:
    """Listens in a thread of its own, in which all three functions are called.

    `on_connect` reads everything again; `on_notices` gets what others tell, in order, and raises
    SQLAlchemyError where it cannot follow; `on_cut_off` is called each second without a connection.
    """

    def __init__(
        self,
        database: Database,
        on_connect: Callable[[], None],
        on_notices: Callable[[Sequence[Notice]], None],
        on_cut_off: Callable[[], None],
    ) -> None:
        self._database = database
        self._on_connect, self._on_notices = on_connect, on_notices
        self._on_cut_off = on_cut_off
        self._closing = Event()
        self._thread = Thread(target=self._run, name="notices", daemon=True)
        self._last_answer = time.monotonic()
        self.is_connected = False

    def start(self) -> None:
        """Begin to listen."""
        self._thread.start()

    def close(self) -> None:
        """Listen no more."""
        self._closing.set()
        self._thread.join()

    def _run(self) -> None:
        while not self._closing.is_set():
            try:
                with self._database.own_connection(_ANSWER_TIMEOUT_S) as connection:
                    self._listen(connection)
            except (SQLAlchemyError, OSError) as error:
                log.warning("notices of other replicas are lost: %s", type(error).__name__)
            except Exception:
                log.exception("notices of other replicas are lost")
            self.is_connected = False
            if time.monotonic() - self._last_answer > CUT_OFF_S:
                self._on_cut_off()
            self._closing.wait(_RETRY_S)

    def _listen(self, connection: Connection) -> None:
        driver: Any = connection.connection.driver_connection
        driver.notifications = deque()  # its own one forgets what comes before the last hundred
        lock_replica(connection, self._database.replica)
        connection.exec_driver_sql(f"LISTEN {self._database.channel}")
        self._on_connect()
        self.is_connected = True
        while not self._closing.is_set():
            select([driver._usock], [], [], _TICK_S)  # noqa: SLF001 - pg8000 has no other way
            connection.exec_driver_sql("SELECT 1")  # reads what has come, and shows that it lives
            self._last_answer = time.monotonic()
            if notices := self._take(driver.notifications):
                self._on_notices(notices)

    def _take(self, payloads: deque[tuple[int, str, str]]) -> list[Notice]:
        """Take the notices of others that have come."""
        notices = []
        while payloads:
            *_, payload = payloads.popleft()
            try:
                envelope = parse_notice(payload)
            except ValueError:
                log.warning("a notice cannot be read; is a replica of another version there?")
                continue
            if envelope.sender != self._database.replica:
                notices.append(envelope.notice)
        return notices
