"""Starting the first process of a cell in namespaces of its own, with unshare(1) of util-linux."""

import os
import shutil
import socket
import subprocess
from collections.abc import Mapping, Sequence

from rtron.errors import SourceError

_OPTIONS = ("--net", "--mount", "--ipc", "--pid", "--fork", "--kill-child", "--mount-proc")
_AS_USER = ("--user", "--map-root-user")
_HELP = "start it as root, or let users make namespaces: sysctl user.max_user_namespaces"


def namespace_command() -> list[str]:
    """Return the command that runs another one in a cell; SourceError if there is none."""
    program = shutil.which("unshare")
    if program is None:
        raise SourceError("unshare is not installed", help="it is part of util-linux")
    return [program, *(_AS_USER if os.getuid() else ()), *_OPTIONS, "--"]


def start_in_namespaces(
    command: Sequence[str], descriptors: Sequence[int], environ: Mapping[str, str]
) -> "subprocess.Popen[bytes]":
    """Start a command as the first process of a cell, in a session of its own.

    A signal for the group of who starts it does not reach the node, which has its own moment to
    end.
    """
    return subprocess.Popen(  # noqa: S603 - our own program
        [*namespace_command(), *command],
        pass_fds=descriptors,
        env=dict(environ),
        start_new_session=True,
    )


def listen_for_guards(path: str, kind: int, user: int) -> socket.socket:
    """Return the socket at which the guard's user gets into the cell.

    SourceError if the place is taken by a cell that is there.
    """
    sock = socket.socket(socket.AF_UNIX, kind)
    with socket.socket(socket.AF_UNIX, kind) as other:
        if other.connect_ex(path) == 0:
            sock.close()
            raise SourceError(f"another cell is at {path}", help="end it first")
    if os.path.lexists(path):
        os.unlink(path)  # noqa: PTH108 - left by one that was killed
    before = os.umask(0o177)
    try:
        sock.bind(path)
    finally:
        os.umask(before)
    os.chown(path, user, -1)
    sock.listen()
    return sock


CANNOT = _HELP
