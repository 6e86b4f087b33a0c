"""The link process's way to the bridge of the guard's app: what waits for a person, and answers.

The bridge decides. It listens for this process at a socket of its own, which no client reaches.
"""

import asyncio
import json
import logging
import os
from pathlib import Path

from rtron.errors import WireError
from rtron.guard.core.control_socket import control_path
from rtron.guard.system.time_limit import run_within
from rtron.guard.system.unix_socket import peer_credentials
from rtron.vocabulary import OpenRequests
from rtron.wire.common.link_protocol import (
    ApprovalCommand,
    CommandResponse,
    decode_open_requests,
    encode_to_guard,
)

log = logging.getLogger(__name__)

LIST_REQUEST = {"requests": "list"}
"""What asks a bridge for its requests; anything else is an `ApprovalCommand`."""
_PERIOD_S = 1.0
_TIMEOUT_S = 2.0
_MAX_RESPONSE = 1 << 19
"""More than the longest list that a bridge answers, bytes."""


def bridge_link_path(app: str) -> Path:
    """Return where the bridge of an app listens for the link process of its guard."""
    return control_path(f"approvals_{app}")


class BridgeRequests:
    """Knows the open requests while it watches a bridge; None if there is none."""

    def __init__(self) -> None:
        self.open: OpenRequests | None = None

    async def watch(self, app: str) -> None:
        """Ask the bridge of an app each second."""
        try:
            while True:
                self.open = await _list_requests(app)
                await asyncio.sleep(_PERIOD_S)
        finally:
            self.open = None

    async def carry_out(self, app: str, command: ApprovalCommand) -> CommandResponse:
        """Let the bridge answer a request as a person says; return what it has done."""
        try:
            answer = json.loads(await _exchange(app, encode_to_guard(command)))
            granted, reason = answer["granted"] is True, str(answer["reason"])
        except (OSError, ValueError, LookupError, TypeError, asyncio.TimeoutError) as error:
            log.warning("the bridge has not answered: %s", error)
            granted, reason = False, "the bridge of the app does not answer: look what is so now"
        return CommandResponse(number=command.number, granted=granted, reason=reason)


async def _list_requests(app: str) -> OpenRequests | None:
    try:
        return decode_open_requests(await _exchange(app, json.dumps(LIST_REQUEST).encode()))
    except (OSError, ValueError, WireError, asyncio.TimeoutError) as error:
        log.debug("no bridge answers: %s", error)
        return None


async def _exchange(app: str, request: bytes) -> bytes:
    """Say a line to a bridge of this user; return the line that it answers. OSError if none."""
    return await run_within(_ask(bridge_link_path(app), request + b"\n"), _TIMEOUT_S)


async def _ask(path: Path, line: bytes) -> bytes:
    reader, writer = await asyncio.open_unix_connection(path, limit=_MAX_RESPONSE)
    try:
        if peer_credentials(writer.get_extra_info("socket"))[1] != os.getuid():
            raise PermissionError("another user listens in the place of the bridge")
        writer.write(line)
        await writer.drain()
        return await reader.readline()
    finally:
        writer.close()
