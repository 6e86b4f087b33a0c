"""What persons ask of one guard or its bridge: sent at once, and answered or not at all."""

from collections.abc import Iterator
from concurrent.futures import Future, InvalidStateError
from contextlib import suppress

from rtron.errors import RTronError, SourceError
from rtron.service.domain.errors import TooManyRequestsError
from rtron.wire.common.link_protocol import (
    ApprovalCommand,
    CommandResponse,
    Hello,
    LeaseCommand,
    PersonCommand,
)

MAX_WAITING = 20
"""How many commands for one guard may wait for its answer."""


class CommandExchange:
    """The commands of one connection without an answer; for its event loop.

    Whoever waits no more cancels the future, and a command that is not sent yet is not sent.
    """

    def __init__(self) -> None:
        self.understood: tuple[type[PersonCommand], ...] = ()
        """The commands that the guard takes."""
        self._unsent: list[PersonCommand] = []
        self._waiting: dict[int, Future[CommandResponse]] = {}

    def add(self, command: PersonCommand, response: Future[CommandResponse]) -> None:
        """Let a command be sent; `response` gets the answer, or why there is none."""
        self._waiting = {n: each for n, each in self._waiting.items() if not each.done()}
        if not isinstance(command, self.understood):
            help = "update RTron on the robot"
            _fail(response, SourceError("the guard does not know such commands", help=help))
        elif len(self._waiting) >= MAX_WAITING:
            _fail(response, TooManyRequestsError("the guard has many commands to answer already"))
        else:
            self._waiting[command.number] = response
            self._unsent.append(command)

    def take(self) -> Iterator[PersonCommand]:
        """Yield what is to be sent, each once."""
        commands, self._unsent = self._unsent, []
        for command in commands:
            response = self._waiting.get(command.number)
            if response and not response.done():
                yield command

    def answer(self, response: CommandResponse) -> None:
        """Take the guard's answer; one that nobody waits for is left."""
        future = self._waiting.pop(response.number, None)
        if future:
            with suppress(InvalidStateError):  # nobody waits any more
                future.set_result(response)

    def close(self) -> None:
        """Let nobody wait any longer: the connection has ended."""
        for response in self._waiting.values():
            _fail(response, SourceError("the guard is gone before it has answered"))


def understood_commands(hello: Hello) -> tuple[type[PersonCommand], ...]:
    """Return the commands that a guard takes, and its link process."""
    leases = (LeaseCommand,) if hello.takes_lease_commands else ()
    return (*leases, ApprovalCommand) if hello.takes_approval_commands else leases


def _fail(response: Future[CommandResponse], error: RTronError) -> None:
    with suppress(InvalidStateError):  # nobody waits any more
        response.set_exception(error)
