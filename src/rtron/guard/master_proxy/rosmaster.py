"""Debian's or ROS's own `rosmaster`, as a child that listens on loopback and ends with us."""

import logging
import os
import shutil
import signal
import socket
import subprocess
import threading
import time
from collections.abc import Mapping
from functools import partial

from rtron.errors import RTronError, SourceError
from rtron.guard.master_proxy.name_registry import CALLER
from rtron.guard.system.process_attributes import end_with_parent
from rtron.wire.ros1.xmlrpc import ros_call

log = logging.getLogger(__name__)

_START_S = 30.0
_END_S = 5.0
_PAUSE_S = 0.02


class Rosmaster:
    """A running private master; SourceError if it does not start.

    `port` 0 is a free one. rosmaster's own file of parameters and registrations is nowhere: it
    forgets all when it ends.
    """

    def __init__(self, port: int = 0) -> None:
        program = shutil.which("rosmaster")
        if program is None:
            help = "source ROS's setup.bash, or install rosmaster"
            raise SourceError("rosmaster is not installed", help=help)
        self.port = port or _free_port()
        self.uri = f"http://127.0.0.1:{self.port}/"
        end_with_us = partial(end_with_parent, os.getpid())
        self._popen = subprocess.Popen(  # noqa: S603 - the user's own ROS
            [program, "--core", "-p", str(self.port)],
            env=_environ(os.environ, self.uri),
            stdin=subprocess.DEVNULL,
            start_new_session=True,  # ^C is for us; we end it
            preexec_fn=end_with_us,  # noqa: PLW1509 - no thread is running yet
        )
        try:
            self._wait()
        except BaseException:
            self.end()
            raise

    @property
    def has_ended(self) -> bool:
        """Whether it has ended by itself."""
        return self._popen.poll() is not None

    def end(self) -> None:
        """End it, with force if it does not listen."""
        for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
            if self.has_ended:
                return
            self._popen.send_signal(number)
            try:
                self._popen.wait(_END_S)
            except subprocess.TimeoutExpired:
                log.warning("rosmaster does not end on signal %d", number)

    def _wait(self) -> None:
        """Wait until it answers, and as the child of ours that it is."""
        deadline, pause = time.monotonic() + _START_S, threading.Event()
        while self._pid() != self._popen.pid:
            if self.has_ended:
                raise SourceError(f"rosmaster ended with code {self._popen.returncode}")
            if time.monotonic() > deadline:
                raise SourceError(f"rosmaster does not answer within {_START_S:g} s")
            pause.wait(_PAUSE_S)

    def _pid(self) -> object:
        try:
            return ros_call(self.uri, "getPid", CALLER, timeout=1.0)
        except RTronError:
            return None


def _environ(environ: Mapping[str, str], uri: str) -> dict[str, str]:
    """Return an environment in which rosmaster binds the loopback address only."""
    inherited = {name: text for name, text in environ.items() if name not in ("ROS_IP", "ROS_IPV6")}
    return inherited | {"ROS_HOSTNAME": "127.0.0.1", "ROS_MASTER_URI": uri}


def _free_port() -> int:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port: int = free.getsockname()[1]
        return port
