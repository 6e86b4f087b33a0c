"""Nodes forked from a process of their Python that has loaded ROS, which is most of their start.

Run as a program, this file is that process: it forks a program for each request on a socket.
"""

import gc
import json
import os
import runpy
import select
import socket
import subprocess
import sys
from contextlib import suppress
from functools import cache
from importlib import import_module
from pathlib import Path
from weakref import finalize

_MAX_BYTES = 1 << 17
_LOST = 256
"""The exit code, which no process has, of one whose server was lost."""


class ForkedNode:
    """A process that is no child of ours, with the methods of `subprocess.Popen` that tests use."""

    def __init__(self, pid, descriptor):
        """Its server writes its exit code there once it has ended."""
        self.pid = pid
        self._descriptor, self._code = descriptor, None
        self._end = select.poll()
        self._end.register(descriptor, select.POLLIN)
        finalize(self, os.close, descriptor)

    def poll(self):
        """Return its exit code, minus the signal that killed it; None while it runs."""
        if self._code is None and self._end.poll(0):
            self._code = int(os.read(self._descriptor, _MAX_BYTES) or _LOST)
        return self._code

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
    """Fork a process for each request, and tell how each ends; return its request in each."""
    running = {}
    while True:
        for ready in select.select([connection, *running], (), ())[0]:
            if ready is not connection:
                _tell_end(ready, *running.pop(ready))
            elif request := _fork(connection, running):
                return json.loads(request)


def _fork(connection, running):
    """Fork a process for the next request, which is returned in that process alone."""
    if not (request := connection.recv(_MAX_BYTES)):
        sys.exit()
    end, code = os.pipe()
    if not (pid := os.fork()):
        connection.close()
        for each in (end, code, *running, *(other for _, other in running.values())):
            os.close(each)
        return request
    running[os.pidfd_open(pid)] = pid, code
    socket.send_fds(connection, [str(pid).encode()], [end])
    os.close(end)
    return None


def _tell_end(descriptor, pid, code):
    """Write the exit code of a process that has ended."""
    os.close(descriptor)
    _, status = os.waitpid(pid, 0)
    with suppress(BrokenPipeError):
        os.write(code, str(os.waitstatus_to_exitcode(status)).encode())
    os.close(code)


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
    for name in modules:
        import_module(name)
    gc.freeze()
    _become(*_serve(socket.socket(fileno=int(number))), former)


if __name__ == "__main__":
    main()
