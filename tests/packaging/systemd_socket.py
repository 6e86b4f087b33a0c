"""systemd's end of its notification socket."""

import socket

_WATCHDOG_USEC = "100000"


class SystemdSocket:
    """A socket that services report to, with every line that has come."""

    def __init__(self, folder):
        self._path = folder / "notify"
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM)
        self._socket.bind(str(self._path))
        self._lines = []

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self._socket.close()

    @property
    def environment(self):
        return {"NOTIFY_SOCKET": str(self._path), "WATCHDOG_USEC": _WATCHDOG_USEC}

    def lines(self):
        while True:
            try:
                message = self._socket.recv(4096, socket.MSG_DONTWAIT)
            except BlockingIOError:
                return self._lines
            self._lines += message.decode().splitlines()

    def has(self, line, since=0):
        return line in self.lines()[since:]
