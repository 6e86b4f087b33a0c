"""The first process of a cell: it checks what it got, starts the others, and ends with the node.

As process 1 of a PID namespace it takes everything in the cell with it (pid_namespaces(7)). It
carries no messages, so there is nothing that could make it hang.
"""

import ctypes
import fcntl
import logging
import math
import os
import select
import signal
import socket
import struct
import subprocess
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import suppress

from rtron.errors import SourceError
from rtron.guard.cell.config import READY, REFUSED, START, CellConfig
from rtron.guard.cell.isolation import SHARED_MEMORY, Gap, find_gaps
from rtron.guard.cell.ros2.environ import copy_parameter_files

log = logging.getLogger(__name__)

_SIOCGIFFLAGS, _SIOCSIFFLAGS, _IFF_UP = 0x8913, 0x8914, 1
"""linux/sockios.h, net/if.h"""
_FLAGS = struct.Struct("16sH14x")
_MS_NOSUID, _MS_NODEV = 2, 4
_NODE_END_S = 10.0
_RESTART_S = 0.5
_START_S, _PAUSE_S = 30.0, 0.02
_MAX_PACKET = 64
_SIGNAL_BASE = 128

StartProgram = Callable[[str], "subprocess.Popen[bytes]"]
"""Starts a program of RTron in the cell by its name."""


def raise_loopback() -> None:
    """Let the cell's own address work; a new network has it, and it is down (netdevice(7))."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sock:
        _, flags = _FLAGS.unpack(fcntl.ioctl(sock, _SIOCGIFFLAGS, _FLAGS.pack(b"lo", 0)))
        fcntl.ioctl(sock, _SIOCSIFFLAGS, _FLAGS.pack(b"lo", flags | _IFF_UP))


def mount_shared_memory() -> None:
    """Give the cell a /dev/shm of its own. OSError if the system does not let us."""
    libc = ctypes.CDLL(None, use_errno=True)
    target, options = str(SHARED_MEMORY).encode(), b"mode=1777"
    if libc.mount(b"rtron-cell", target, b"tmpfs", _MS_NOSUID | _MS_NODEV, options):
        error = ctypes.get_errno()
        raise OSError(error, os.strerror(error), str(SHARED_MEMORY))


def _own_folder() -> "tempfile.TemporaryDirectory[str]":
    """Return a folder that nobody else may enter, and that ends with the cell."""
    return tempfile.TemporaryDirectory(prefix="rtron-", dir=SHARED_MEMORY)


def _await_port(port: int) -> None:
    """Wait until somebody listens at a port in the cell; 0 is none."""
    until = time.monotonic() + _START_S
    while port and not _listens(port):
        if time.monotonic() > until:
            raise SourceError(f"nobody listens at port {port} of the cell")
        time.sleep(_PAUSE_S)


def _listens(port: int) -> bool:
    with socket.socket() as sock:
        return sock.connect_ex(("127.0.0.1", port)) == 0


class CellInit:
    """Starts the cell's processes in order, and waits for them.

    `services` are the programs of RTron that the node needs, with the port on which the next one
    waits, or 0; one that ends is started again.
    """

    def __init__(
        self,
        config: CellConfig,
        control: socket.socket,
        start_program: StartProgram,
        services: Sequence[tuple[str, int]],
    ) -> None:
        self._config = config
        self._control = control
        self._start_program = start_program
        self._services = services
        self._children: dict[int, str] = {}
        self._processes: list[subprocess.Popen[bytes]] = []
        self._node = 0
        self._kill_at = 0.0
        self._restarts: list[tuple[float, str]] = []
        self._inputs: list[socket.socket | int] = [control]
        self._wake, wake = os.pipe2(os.O_NONBLOCK | os.O_CLOEXEC)
        signal.signal(signal.SIGCHLD, lambda *_: None)
        signal.set_wakeup_fd(wake, warn_on_full_buffer=False)

    def run(self) -> int:
        """Be the cell; return the exit code of its node."""
        raise_loopback()
        if Gap.SHARED_MEMORY not in self._config.allowed:
            mount_shared_memory()
        self._check()
        with _own_folder() as folder, _own_folder() as node_folder:
            os.environ["XDG_RUNTIME_DIR"] = folder
            for service, port in self._services:
                self._start_service(service)
                _await_port(port)
            self._control.send(READY)
            return self._wait(node_folder)

    def _check(self) -> None:
        """Refuse a cell that lacks a separation which nobody has allowed it to lack."""
        gaps = find_gaps(self._config.outside, self._config.user)
        for gap in gaps:
            is_allowed = gap in self._config.allowed
            log.log(logging.WARNING if is_allowed else logging.ERROR, "%s", gap.value)
        missing = [gap.name for gap in gaps if gap not in self._config.allowed]
        if missing:
            self._control.send(REFUSED + b" " + ",".join(missing).encode())
            raise SourceError("this is no cell")

    def _wait(self, node_folder: str) -> int:
        while True:
            inputs = (*self._inputs, self._wake)
            ready, _, _ = select.select(inputs, (), (), self._timeout())
            with suppress(BlockingIOError):
                os.read(self._wake, _MAX_PACKET)
            if self._control in ready and not self._obey(
                self._control.recv(_MAX_PACKET), node_folder
            ):
                return _SIGNAL_BASE + signal.SIGTERM
            code = self._reap()
            if code is not None:
                return code
            self._act_on_time()

    def _obey(self, request: bytes, node_folder: str) -> bool:
        """Do what the gateway asks for; return whether the cell goes on."""
        if request == START:
            self._start_node(node_folder)
        elif request:
            self._end_node(int(request))
        else:  # the gateway is gone
            self._inputs.clear()
            self._end_node(signal.SIGTERM)
        return bool(self._node)

    def _end_node(self, number: int) -> None:
        self._kill_at = self._kill_at or time.monotonic() + _NODE_END_S
        if self._node:
            with suppress(ProcessLookupError):
                os.kill(self._node, number)

    def _start_service(self, name: str) -> None:
        process = self._start_program(name)
        self._processes.append(process)
        self._children[process.pid] = name

    def _start_node(self, folder: str) -> None:
        config = self._config
        os.chown(folder, config.user, config.group)
        places = {"HOME": config.home or folder, "XDG_RUNTIME_DIR": folder}
        is_other = config.user != os.getuid()
        try:
            process = subprocess.Popen(  # noqa: S603 - the user's own node
                copy_parameter_files(config.command, folder),
                env={**os.environ, **places},
                user=config.user if is_other else None,
                group=config.group if is_other else None,
                extra_groups=config.groups if is_other else None,
            )
        except OSError as error:
            why = f"{config.command[0]} cannot be started: {error.strerror}"
            raise SourceError(why, help=f"may user {config.user} run it?") from None
        self._processes.append(process)
        self._node = process.pid

    def _reap(self) -> int | None:
        """Collect who has ended; return the node's exit code if it is the node."""
        while True:
            try:
                pid, status = os.waitpid(-1, os.WNOHANG)
            except ChildProcessError:
                return None
            if not pid:
                return None
            if pid == self._node:
                code = os.waitstatus_to_exitcode(status)
                return code if code >= 0 else _SIGNAL_BASE - code
            if pid in self._children:
                self._on_service_end(self._children.pop(pid))

    def _on_service_end(self, name: str) -> None:
        log.error("%s in the cell has ended; it is started again", name)
        self._restarts.append((time.monotonic() + _RESTART_S, name))

    def _act_on_time(self) -> None:
        now = time.monotonic()
        if self._kill_at and now >= self._kill_at and self._node:
            self._kill_at = math.inf
            with suppress(ProcessLookupError):
                os.kill(self._node, signal.SIGKILL)
        due = [name for at, name in self._restarts if at <= now]
        self._restarts = [each for each in self._restarts if each[0] > now]
        for name in due:
            self._start_service(name)

    def _timeout(self) -> float | None:
        times = [at for at, _ in self._restarts]
        due = min([*times, self._kill_at or math.inf])
        return None if due == math.inf else max(0.0, due - time.monotonic())
