"""Reports of the incidents on this robot, each sent until the service has it.

A report is made by a program of its own, which reads the file and plays it once more: that takes
seconds of a processor, at the link process's low priority, and nobody waits for it.
"""

import asyncio
import logging
from asyncio.subprocess import DEVNULL, PIPE
from collections.abc import Collection
from contextlib import suppress

from rtron.errors import WireError
from rtron.guard.link.options import LinkOptions
from rtron.guard.system.durable_file import replace_file
from rtron.guard.system.state_folder import INCIDENTS
from rtron.guard.system.time_limit import run_within
from rtron.wire.common.link_protocol import IncidentSaved, decode_from_guard, encode_incident

log = logging.getLogger(__name__)

MAX_BACKLOG = 20
"""Of incidents that were saved before anybody took reports, only so many are reported."""
_MAX_ATTEMPTS = 3
_LOOK_S = 2.0
_ANSWER_S = 30.0
_REPORT_S = 120.0
_LONGEST_REASON = 200


class IncidentReports:
    """Finds incidents that the service does not have, the newest first."""

    def __init__(self, options: LinkOptions) -> None:
        self._folder = options.state / INCIDENTS
        self._file = options.reported_incidents_file
        self._command = options.report_command
        self._message: tuple[str, bytes] | None = None
        self._attempts = 0
        self._is_stored = asyncio.Event()

    async def next_message(self) -> bytes:
        """Return the message of the next report; wait until there is an incident for it."""
        while self._message is None:
            name = await asyncio.to_thread(self._find_next) if self._command else None
            if name is None:
                await asyncio.sleep(_LOOK_S)
            elif message := await self._make(name):
                self._message, self._attempts = (name, message), 0
            else:
                await asyncio.to_thread(self._note_reported, [name])
        self._is_stored.clear()
        return self._message[1]

    def confirm(self, name: str) -> None:
        """Take note that the service has the report of this incident."""
        if self._message and self._message[0] == name:
            self._is_stored.set()

    async def settle(self) -> None:
        """Wait for the answer to what was sent; what is never answered is given up."""
        with suppress(asyncio.TimeoutError):
            await run_within(self._is_stored.wait(), _ANSWER_S)
        self._attempts += 1
        if self._message and (self._is_stored.is_set() or self._attempts >= _MAX_ATTEMPTS):
            name = self._message[0]
            self._message = None
            await asyncio.to_thread(self._note_reported, [name])

    def _find_next(self) -> str | None:
        """Return the newest incident that is not reported; forget those of long ago."""
        reported = self._reported()
        names = sorted(path.name for path in self._folder.glob("*.mcap"))
        missing = [name for name in names if name not in reported]
        if len(missing) > MAX_BACKLOG:
            self._note_reported(missing[:-MAX_BACKLOG])
        return missing[-1] if missing else None

    async def _make(self, name: str) -> bytes | None:
        """Return the message of an incident's report; None if there can be none."""
        output, problem = await self._run(name)
        try:
            message = encode_incident(output.strip())
            if not problem and isinstance(decode_from_guard(message), IncidentSaved):
                return message
        except WireError as error:
            problem = str(error)
        log.warning("%s is not reported: %s", name, problem)
        return None

    async def _run(self, name: str) -> tuple[bytes, str]:
        """Run the program; return what it wrote, and why it failed, if it has."""
        words = *self._command, str(self._folder / name)
        try:
            process = await asyncio.create_subprocess_exec(
                *words, cwd=self._folder, stdin=DEVNULL, stdout=PIPE, stderr=PIPE
            )
        except OSError as error:
            return b"", str(error)
        try:
            output, errors = await run_within(process.communicate(), _REPORT_S)
        except asyncio.TimeoutError:
            return b"", f"it takes more than {_REPORT_S:g} s"
        finally:
            with suppress(ProcessLookupError):
                process.kill()
            await process.wait()
        reason = errors.decode(errors="replace")[:_LONGEST_REASON]
        return output, reason or "no report" if process.returncode else ""

    def _reported(self) -> frozenset[str]:
        try:
            return frozenset(self._file.read_text().splitlines())
        except (OSError, ValueError):
            return frozenset()

    def _note_reported(self, names: Collection[str]) -> None:
        """Keep the names of those that are still there; a full disk only repeats a report."""
        present = {path.name for path in self._folder.glob("*.mcap")}
        noted = sorted(present & {*self._reported(), *names})
        try:
            replace_file(self._file, "".join(f"{name}\n" for name in noted).encode())
        except OSError as error:
            log.warning("which incidents are reported is not kept: %s", error)
