"""Sends persons' commands to guards that are connected to another replica."""

from concurrent.futures import Future, InvalidStateError
from contextlib import suppress
from dataclasses import replace
from functools import partial
from threading import Lock

from rtron.service.live.hub import Hub
from rtron.service.replicas.shared_throttles import NoticeQueue
from rtron.service.store.database import Database
from rtron.service.store.notices import (
    CommandNotice,
    ResponseNotice,
    post_notice,
)
from rtron.wire.common.link_protocol import CommandResponse, PersonCommand

_MAX_REASON = 1000
"""PostgreSQL delivers no notice of 8,000 bytes or more."""


class CommandRelay:
    """Lets the replica that has a guard send it commands; all may be called from any thread."""

    def __init__(self, database: Database, hub: Hub, queue: NoticeQueue) -> None:
        self._database = database
        self._hub, self._queue = hub, queue
        self._lock = Lock()
        self._waiting: dict[int, Future[CommandResponse]] = {}

    def send(self, robot: str, command: PersonCommand) -> Future[CommandResponse]:
        """Let another replica send a command; return what will have the answer, if one comes."""
        response: Future[CommandResponse] = Future()
        with self._lock:
            self._waiting[command.number] = response
        response.add_done_callback(lambda _: self._forget(command.number))
        with self._database.session() as session:
            post_notice(session, CommandNotice(robot=robot, command=command))
        return response

    def take_command(self, notice: CommandNotice) -> None:
        """Send a command of another replica, if the guard is connected here."""
        response = self._hub.send_command(notice.robot, notice.command)
        if response is not None:
            response.add_done_callback(partial(self._tell, notice.command.number))

    def take_response(self, response: CommandResponse) -> None:
        """Take the answer that another replica has got."""
        with self._lock:
            waiting = self._waiting.get(response.number)
        if waiting:
            with suppress(InvalidStateError):  # nobody waits any more
                waiting.set_result(response)

    def _tell(self, number: int, answered: Future[CommandResponse]) -> None:
        """Tell the one who asks what has become of a command."""
        error = answered.exception()
        if error:
            response = CommandResponse(number=number, granted=False, reason=str(error))
        else:
            response = answered.result()
        shortened = replace(response, reason=response.reason[:_MAX_REASON])
        self._queue.put(ResponseNotice(response=shortened))

    def _forget(self, number: int) -> None:
        with self._lock:
            self._waiting.pop(number, None)
