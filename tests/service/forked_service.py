"""`rtron serve` forked from a process that has loaded it: to load it takes a second of processor.

Who tests the command itself starts it as people do.
"""

import os
import subprocess
import sys
from multiprocessing import get_context

_LOADED = (
    "rtron.cli.main",
    "rtron.cli.commands.serve",
    "rtron.service.server.app",
    "rtron.service.server.http",
    "rtron.service.server.oidc_setup",
    "alembic.config",
    "alembic.runtime.environment",
    "alembic.script",
)
_forkserver = get_context("forkserver")
_forkserver.set_forkserver_preload(list(_LOADED))


class ForkedService:
    """A process of `rtron serve`, with the methods of `subprocess.Popen` that tests use."""

    def __init__(self, arguments, folder, log):
        """Start it in a folder; what it says goes to the end of a file, which is there at once."""
        log.touch()
        given = ["rtron", "serve", *map(str, arguments)]
        parts = (given, str(folder), str(log), dict(os.environ))
        self._process = _forkserver.Process(target=_serve, args=parts)
        self._process.start()
        self.pid = self._process.pid

    @property
    def returncode(self):
        """Its exit code, None while it runs."""
        return self._process.exitcode

    def poll(self):
        """Return its exit code, None while it runs."""
        return self._process.exitcode

    def wait(self, timeout):
        """Wait until it ends; return its exit code."""
        self._process.join(timeout)
        if self._process.exitcode is None:
            raise subprocess.TimeoutExpired("rtron serve", timeout)
        return self._process.exitcode

    def terminate(self):
        """Tell it to end."""
        self._process.terminate()

    def kill(self):
        """End it without a word."""
        self._process.kill()


def _serve(arguments, folder, log, environment):
    """Be `rtron serve`, in the new process."""
    from rtron.__main__ import main  # noqa: PLC0415 - it is loaded there

    os.chdir(folder)
    output = os.open(log, os.O_WRONLY | os.O_APPEND | os.O_CREAT)
    for stream in (sys.stdout, sys.stderr):
        os.dup2(output, stream.fileno())
    os.close(output)
    os.environ.clear()
    os.environ.update(environment)
    sys.argv = arguments
    main()
