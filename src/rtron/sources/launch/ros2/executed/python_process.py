"""A process that runs strange code: it gets so much time, and all that it started ends with it."""

import os
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import BinaryIO
from uuid import uuid4

from rtron.errors import SourceError

_TOKEN_VARIABLE = "RTRON_VISIT"  # noqa: S105 - a name of a variable
_POLL_S = 0.02
_MAX_ATTEMPTS = 20


def run_with_timeout(
    command: Sequence[str], environ: Mapping[str, str], seconds: float, log: BinaryIO
) -> None:
    """Run a command to its end; raise SourceError where it takes longer. Nothing of it stays.

    What it says to standard error goes to `log`, its standard output nowhere.
    """
    token = f"{_TOKEN_VARIABLE}={uuid4().hex}"
    name, _, value = token.partition("=")
    with _start(command, {**environ, name: value}, log) as process:
        try:
            _wait_for_exit(process, seconds)
        finally:
            _kill_group(process)
            _kill_tagged(token.encode())


@contextmanager
def _start(
    command: Sequence[str], environ: Mapping[str, str], log: BinaryIO
) -> Iterator["subprocess.Popen[bytes]"]:
    null = subprocess.DEVNULL
    try:
        process = subprocess.Popen(  # noqa: S603 - the user asked for it
            command, env=environ, stdin=null, stdout=null, stderr=log, start_new_session=True
        )
    except OSError as error:
        raise SourceError(f"{command[0]}: {error.strerror}") from None
    with process:
        yield process


def _wait_for_exit(process: "subprocess.Popen[bytes]", seconds: float) -> None:
    """Wait for a process, and leave it to be reaped: until then its group's number is its own."""
    deadline = time.monotonic() + seconds
    flags = os.WEXITED | os.WNOWAIT | os.WNOHANG
    while os.waitid(os.P_PID, process.pid, flags) is None:
        if time.monotonic() > deadline:
            raise SourceError(f"it did not end within {seconds:g} s and was ended")
        time.sleep(_POLL_S)


def _kill_group(process: "subprocess.Popen[bytes]") -> None:
    with suppress(ProcessLookupError, PermissionError):  # the group has ended
        os.killpg(process.pid, signal.SIGKILL)


def _kill_tagged(token: bytes) -> None:
    """End all processes that have the token in their environment, also those of other sessions."""
    for _ in range(_MAX_ATTEMPTS):
        killed = [pid for pid in _pids() if _kill_if_tagged(pid, token)]
        if not killed:
            return
        time.sleep(_POLL_S)


def _kill_if_tagged(pid: int, token: bytes) -> bool:
    """End a process that has the token; the descriptor is of it alone, whatever its number."""
    with suppress(OSError):  # it has ended, or belongs to another user
        descriptor = os.pidfd_open(pid)
        try:
            if token in Path(f"/proc/{pid}/environ").read_bytes().split(b"\0"):
                signal.pidfd_send_signal(descriptor, signal.SIGKILL)
                return True
        finally:
            os.close(descriptor)
    return False


def _pids() -> Iterator[int]:
    with suppress(OSError):  # /proc is not readable here
        yield from (int(entry.name) for entry in Path("/proc").iterdir() if entry.name.isdigit())


_MAX_LINE = 256


def find_pythons(environ: Mapping[str, str]) -> Iterator[str]:
    """Yield where launch may be: the Python of `ros2`, that of the PATH, RTron's own."""
    path = environ.get("PATH", "")
    candidates = [
        _script_interpreter(shutil.which("ros2", path=path)),
        shutil.which("python3", path=path),
    ]
    yield from dict.fromkeys(filter(None, (*candidates, sys.executable)))


def _script_interpreter(script: str | None) -> str | None:
    """Return the interpreter that a script's first line names; None where `env` finds it."""
    if script is None:
        return None
    try:
        with Path(script).open("rb") as stream:
            line = stream.readline(_MAX_LINE).decode(errors="replace")
    except OSError:
        return None
    words = line.removeprefix("#!").split() if line.startswith("#!") else []
    return words[0] if words and "python" in Path(words[0]).name else None
