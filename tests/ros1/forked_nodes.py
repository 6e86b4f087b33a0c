"""Nodes forked from a process of their Python that has loaded ROS, which is most of their start.

Run as a program, this file is that process: it forks a program for each request on a socket.
"""

import gc
import json
import os
import runpy
import select
import signal
import socket
import subprocess
import sys
from functools import cache
from importlib import import_module
from pathlib import Path
from weakref import finalize

_MAX_BYTES = 1 << 17
_CHILD_ENDS = {signal.SIGCHLD}


class ForkedNode:
    """A process that is no child of ours, with the methods of `subprocess.Popen` that tests use."""

    def __init__(self, pid, descriptor):
        self.pid = pid
        self._end = select.poll()
        self._end.register(descriptor, select.POLLIN)
        finalize(self, os.close, descriptor)

    def poll(self):
        """Return 0 once it has ended, however it did."""
        return 0 if self._end.poll(0) else None

    def wait(self, timeout=None):
        """Wait until it has ended."""
        if not self._end.poll(None if timeout is None else 1000 * timeout):
            raise subprocess.TimeoutExpired(str(self.pid), timeout)


def fork_node(python, modules, arguments, environ, log):
    """Start a script by a Python that has loaded these modules; what it says goes to a file."""
    connection, _ = _fork_server(python, modules)
    connection.sendall(json.dumps([list(map(str, arguments)), environ, str(log)]).encode())
    pid, (descriptor,), _, _ = socket.recv_fds(connection, _MAX_BYTES, 1)
    return ForkedNode(int(pid), descriptor)


@cache
def _fork_server(python, modules):
    """Start the process that forks; it ends with this one."""
    ours, theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with theirs:
        number = theirs.fileno()
        command = [python, __file__, str(number), *modules]
        return ours, subprocess.Popen(command, pass_fds=[number], start_new_session=True)


def _serve(connection):
    """Fork a process for each request; return its request in each."""
    while data := connection.recv(_MAX_BYTES):
        signal.pthread_sigmask(signal.SIG_BLOCK, _CHILD_ENDS)
        if not (pid := os.fork()):
            connection.close()
            signal.signal(signal.SIGCHLD, signal.SIG_DFL)
            signal.pthread_sigmask(signal.SIG_UNBLOCK, _CHILD_ENDS)
            return json.loads(data)
        descriptor = os.pidfd_open(pid)
        signal.pthread_sigmask(signal.SIG_UNBLOCK, _CHILD_ENDS)
        socket.send_fds(connection, [str(pid).encode()], [descriptor])
        os.close(descriptor)
    sys.exit()


def _become(arguments, environ, log, former):
    """Be the script, with a session, a log and an environment of its own."""
    os.setsid()
    for path, flags, numbers in ((os.devnull, os.O_RDONLY, [0]), (log, os.O_WRONLY, [1, 2])):
        descriptor = os.open(path, flags)
        for number in numbers:
            os.dup2(descriptor, number)
        os.close(descriptor)
    for name in former - environ.keys():
        os.environ.pop(name, None)
    os.environ.update(environ)
    sys.stdout.reconfigure(write_through=True)
    sys.argv[:] = arguments
    search = environ.get("PYTHONPATH", "").split(":")
    sys.path[:1] = [str(Path(arguments[0]).parent), *filter(None, search)]
    runpy.run_path(arguments[0], run_name="__main__")


def main():
    """Load the modules, and fork until whoever asks is gone."""
    former = set(os.environ)
    number, *modules = sys.argv[1:]
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)  # the system collects who has ended
    for name in modules:
        import_module(name)
    gc.freeze()
    _become(*_serve(socket.socket(fileno=int(number))), former)


if __name__ == "__main__":
    main()
