"""Processes that are not started: to launch they look as if they ran for days, and ended well."""

import asyncio
from collections.abc import Callable
from typing import Any, TypeAlias

Protocol: TypeAlias = Any

EXIT_DELAY_S = 1e6
"""After how many seconds of the clock one ends: when all timers of a launch have fired."""
UNUSED_PID = 2**30
"""More than any system gives (Linux: pid_max), so that nobody else gets a signal."""
_started_commands: list[object] = []


class _Transport:
    """A process's transport, as far as launch uses it."""

    def get_pid(self) -> int:
        return UNUSED_PID

    def get_returncode(self) -> int:
        return 0

    def get_pipe_transport(self, _: int) -> None:
        return None

    def send_signal(self, _: int) -> None:
        """Do nothing: there is nobody."""

    def kill(self) -> None:
        """Do nothing: there is nobody."""

    def close(self) -> None:
        """Do nothing: nothing is open."""


async def start_nothing(
    protocol_class: Callable[[], Protocol], cmd: object = None, **_: object
) -> tuple[_Transport, Protocol]:
    """Return what `async_execute_process` returns, with no process; none starts twice."""
    if any(cmd is started for started in _started_commands):
        raise RuntimeError("it would start again")
    _started_commands.append(cmd)
    transport, protocol = _Transport(), protocol_class()
    protocol.connection_made(transport)
    asyncio.get_running_loop().call_later(EXIT_DELAY_S, protocol.process_exited)
    return transport, protocol
