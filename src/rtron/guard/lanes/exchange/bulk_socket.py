"""Where the bulk process of a guard listens: a socket in a folder that only the user may enter.

Another user could take an address that is in no folder (unix(7)), and with it the audit's place.
"""

import fcntl
import os
import socket
from contextlib import ExitStack
from pathlib import Path

from rtron import __version__
from rtron.errors import SourceError
from rtron.guard.system.unix_socket import open_own_folder, runtime_folder, user_name

GREETING = b"B"
"""What a bulk process says first, and sends its board with."""
_LOCKS = "rtron-bulk.lock"
_HELP = "set XDG_RUNTIME_DIR to a folder of your own (mode 700)"
_OFFSET_DIGITS = 15


class BulkSocket:
    """The socket of the guards with one configuration, by its digest; one process has it.

    What stands on the board is known by its place in the plan, and a message by its class: a guard
    with another plan, or of another RTron, never finds it. SourceError if the folder is not ours.
    """

    def __init__(self, configuration: str) -> None:
        name = user_name("bulk", f"{configuration} {__version__}".encode())
        self._folder = _open_folder()
        self._descriptors = ExitStack()
        self._descriptors.callback(os.close, self._folder)
        self._path = Path(f"/proc/self/fd/{self._folder}/{name}")
        self._offset = int(name[-_OFFSET_DIGITS:], 16)
        self._locks = os.open(
            _LOCKS, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600, dir_fd=self._folder
        )
        self._descriptors.callback(os.close, self._locks)

    def listen(self) -> socket.socket:
        """Return the socket; its process has it until it ends. SourceError if another has it."""
        if not self._lock():
            raise SourceError(
                "the guard has a bulk process already", help="it ends soon after its supervisor"
            )
        self._path.unlink(missing_ok=True)
        sock = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            sock.bind(str(self._path))
        except OSError as error:
            sock.close()
            raise SourceError(f"{self._path}: {error.strerror}", help=_HELP) from None
        sock.listen()
        sock.settimeout(0)
        return sock

    def connect(self, sock: socket.socket) -> bool:
        """Connect to the process that listens; False if none does."""
        return sock.connect_ex(str(self._path)) == 0

    def close(self) -> None:
        """Let go of the folder, and of the place; a second call does nothing."""
        self._descriptors.close()

    def _lock(self) -> bool:
        """Lock the place of this configuration until this process ends; False if another has."""
        try:
            fcntl.lockf(self._locks, fcntl.LOCK_EX | fcntl.LOCK_NB, 1, self._offset)
        except OSError:
            return False
        return True


def _open_folder() -> int:
    folder = runtime_folder()
    try:
        return open_own_folder(folder, _HELP)
    except OSError as error:
        raise SourceError(f"{folder}: {error.strerror}", help=_HELP) from None
