"""Hands apps to the processes that scan them, from threads."""

import subprocess
import sys
from contextlib import suppress
from dataclasses import dataclass, field
from typing import IO, cast

from rtron.errors import SourceError
from rtron.survey.app_listing import REQUEST_ADAPTER, ScanRequest
from rtron.survey.app_survey import RESULT_ADAPTER, AppResult

_COMMAND = (sys.executable, "-m", "rtron.survey.scan_server")


class _ScanServer:
    """A process that scans; a session of its own keeps a terminal's Ctrl-C from it."""

    def __init__(self) -> None:
        self._process = subprocess.Popen(  # noqa: S603 - our own command
            _COMMAND,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        )
        self._requests = cast("IO[bytes]", self._process.stdin)
        self._answers = cast("IO[bytes]", self._process.stdout)

    def scan(self, request: ScanRequest) -> AppResult:
        """Return what became of an app; raise SourceError if the process has ended."""
        with suppress(BrokenPipeError):  # then there is no answer
            self._requests.write(REQUEST_ADAPTER.dump_json(request) + b"\n")
            self._requests.flush()
        answer = self._answers.readline()
        if not answer.endswith(b"\n"):
            raise SourceError("the process that scans apps ended")
        return RESULT_ADAPTER.validate_json(answer)

    def end(self) -> None:
        """End the process and the scan that it is at."""
        with suppress(BrokenPipeError), self._process:  # a request that it never read is left
            self._process.kill()


@dataclass(slots=True)
class ScanServers:
    """As many processes that scan as there are scans at a time; each is started when needed."""

    _idle: list[_ScanServer] = field(default_factory=list)
    _started: list[_ScanServer] = field(default_factory=list)

    def scan(self, request: ScanRequest) -> AppResult:
        """Return what became of an app; raise SourceError if the process that scans it ended."""
        try:
            server = self._idle.pop()
        except IndexError:
            server = _ScanServer()
            self._started.append(server)
        result = server.scan(request)
        self._idle.append(server)
        return result

    def close(self) -> None:
        """End all processes, and with them the scans that are under way."""
        for server in self._started:
            server.end()
