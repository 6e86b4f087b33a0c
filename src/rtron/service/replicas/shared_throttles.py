"""Failed logins and wrong codes count at every replica: a guesser gains nothing by asking all."""

import logging
from collections.abc import Sequence
from queue import Empty, SimpleQueue
from typing import Literal

from sqlalchemy.exc import SQLAlchemyError

from rtron.service.domain.clock import Clock
from rtron.service.domain.code_throttle import CodeThrottle
from rtron.service.domain.login_throttle import LoginThrottle
from rtron.service.store.database import Database
from rtron.service.store.notices import CodeNotice, LoginNotice, Notice, post_notice

log = logging.getLogger(__name__)

_MAX_QUEUED = 1000


class NoticeQueue:
    """Notices for other replicas, which `run` posts: whoever puts them does not wait."""

    def __init__(self, database: Database) -> None:
        self._database = database
        self._queue: SimpleQueue[Notice | None] = SimpleQueue()

    def put(self, notice: Notice) -> None:
        """Let a notice be posted soon; where very many wait, it is not."""
        if self._queue.qsize() < _MAX_QUEUED:
            self._queue.put(notice)

    def run(self) -> None:
        """Post notices until `close`."""
        while notices := self._take():
            self._post(notices)

    def close(self) -> None:
        """Let `run` end."""
        self._queue.put(None)

    def _post(self, notices: Sequence[Notice]) -> None:
        try:
            with self._database.session() as session:
                for notice in notices:
                    post_notice(session, notice)
        except SQLAlchemyError as error:
            log.warning("notices for other replicas are lost: %s", type(error).__name__)

    def _take(self) -> list[Notice]:
        """Wait for a notice; return all that wait, none at the end."""
        taken = []
        notice = self._queue.get()
        while notice is not None:
            taken.append(notice)
            try:
                notice = self._queue.get_nowait()
            except Empty:
                return taken
        return []


class SharedLoginThrottle(LoginThrottle):
    """Tells other replicas of attempts; `clock` is that of the `now` of attempts."""

    def __init__(self, queue: NoticeQueue, clock: Clock) -> None:
        super().__init__()
        self._queue, self._clock = queue, clock

    def begin_attempt(self, name: str, address: str, now: int, browser: str = "") -> int:
        """Count an attempt as failed before it is judged; return how long to wait instead, ns."""
        delay = super().begin_attempt(name, address, now, browser)
        if not delay:
            self._tell("begun", name, address, browser)
        return delay

    def cancel_attempt(self, name: str, address: str, browser: str = "") -> None:
        """Take back an attempt that nobody has judged; the failures before it stay."""
        super().cancel_attempt(name, address, browser)
        self._tell("cancelled", name, address, browser)

    def record_success(self, name: str, address: str, browser: str = "") -> None:
        """Take back an attempt; the failures before it stay those of the address."""
        super().record_success(name, address, browser)
        self._tell("succeeded", name, address, browser)

    def note(self, notice: LoginNotice) -> None:
        """Take note of an attempt at another replica."""
        if notice.step == "begun":
            self.count_attempt(notice.name, notice.address, self._clock(), notice.browser)
        elif notice.step == "cancelled":
            super().cancel_attempt(notice.name, notice.address, notice.browser)
        else:
            super().record_success(notice.name, notice.address, notice.browser)

    def _tell(
        self,
        step: Literal["begun", "cancelled", "succeeded"],
        name: str,
        address: str,
        browser: str,
    ) -> None:
        self._queue.put(LoginNotice(step=step, name=name, address=address, browser=browser))


class SharedCodeThrottle(CodeThrottle):
    """Tells other replicas of one-time codes; `clock` is that of the `now` of attempts."""

    def __init__(self, queue: NoticeQueue, clock: Clock) -> None:
        super().__init__()
        self._queue, self._clock = queue, clock

    def begin_attempt(self, name: str, known_origin: str, now: int) -> int:
        """Count an attempt as failed before it is judged; return how long to wait instead, ns."""
        delay = super().begin_attempt(name, known_origin, now)
        if not delay:
            self._queue.put(CodeNotice(step="begun", name=name, known_origin=known_origin))
        return delay

    def record_success(self, name: str, known_origin: str) -> None:
        """Forget what failed there: the code was right."""
        super().record_success(name, known_origin)
        self._queue.put(CodeNotice(step="succeeded", name=name, known_origin=known_origin))

    def note(self, notice: CodeNotice) -> None:
        """Take note of an attempt at another replica."""
        if notice.step == "begun":
            self.count_attempt(notice.name, notice.known_origin, self._clock())
        else:
            super().record_success(notice.name, notice.known_origin)


class SharedThrottles:
    """Both throttles of a replica, and the queue of what they tell."""

    def __init__(self, database: Database, clock: Clock) -> None:
        self.queue = NoticeQueue(database)
        self.logins = SharedLoginThrottle(self.queue, clock)
        self.codes = SharedCodeThrottle(self.queue, clock)

    def note(self, notice: Notice) -> None:
        """Take note of an attempt at another replica, if the notice is of one."""
        if isinstance(notice, LoginNotice):
            self.logins.note(notice)
        elif isinstance(notice, CodeNotice):
            self.codes.note(notice)
