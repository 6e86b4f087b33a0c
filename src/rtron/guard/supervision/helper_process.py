"""The processes beside the guard: started, again when they end or hang, and ended at its end."""

import logging
import signal
import time
from collections.abc import Callable, Iterator, Sequence

from rtron.guard.supervision.fork_server import ForkedProcess, ForkServer
from rtron.guard.supervision.guard_config import GuardConfig
from rtron.guard.supervision.programs import BULK, INCIDENTS, LINK, process_name
from rtron.guard.supervision.watchdog import HangWatch
from rtron.guard.system.process_port import ProcessPort
from rtron.guard.system.sealed_memory import SharedBeat
from rtron.vocabulary import SECOND

log = logging.getLogger(__name__)

MIN_RESTART_DELAY = SECOND
"""The time before the next start of one that ended soon, ns; it doubles while each does."""
MAX_RESTART_DELAY = 4 * SECOND
_LOOK_PERIOD = SECOND // 10
_END_S, _LEAST_S = 15.0, 1.0
"""How long the helpers may take to end together, and each at least; systemd's unit gives 20 s."""


class HelperProcess:
    """Keeps one process running; the robot is stopped or slowed while it is away, at most.

    One that ends at once is tried more seldom.
    """

    def __init__(
        self,
        server: ForkServer,
        config_file: int,
        program: str,
        *,
        files: Sequence[int] = (),
        beat: SharedBeat | None = None,
        has_plan: bool = True,
        is_needed: Callable[[], bool] = lambda: True,
    ) -> None:
        """Start the program with the configuration and `files`; one that `has_plan` follows it.

        One that has a `beat` gets it as the first of its files. It is started when it `is_needed`.
        """
        self._files = [beat.descriptor, *files] if beat else files
        self._beat, self._has_plan, self._is_needed = beat, has_plan, is_needed
        self.process: ForkedProcess | None = None
        self._server = server
        self._program = program
        self._process_name = process_name(program)
        self._config_file = config_file
        self._started_at = 0
        self._hang_watch = HangWatch(0, SharedBeat.PERIOD)
        self._start_due: int | None = 0
        self._restart_delay = MIN_RESTART_DELAY

    def tick(self, now: int) -> None:
        """Start the process at `now` (ns) if it does not run and it is time."""
        if self.process and self.process.poll() is None:
            self._end_if_hung(now, self.process)
            return
        if self._start_due is None:
            self._start_due = now + self._wait(now - self._started_at)
        if now >= self._start_due:
            self._start_due = now + _LOOK_PERIOD
            if self._is_needed():
                self._start(now)

    def _end_if_hung(self, now: int, process: ForkedProcess) -> None:
        if self._beat and self._hang_watch.is_hung(now, self._beat.at):
            log.error("%s stands still: it is killed", self._process_name)
            process.send_signal(signal.SIGKILL)

    def _wait(self, life: int) -> int:
        """Return how long to wait after one that has lived for `life`."""
        if life >= MAX_RESTART_DELAY:
            self._restart_delay = MIN_RESTART_DELAY
            return 0
        wait, self._restart_delay = (
            self._restart_delay,
            min(2 * self._restart_delay, MAX_RESTART_DELAY),
        )
        return wait

    def _start(self, now: int) -> None:
        self._started_at, self._start_due = now, None
        self._hang_watch = HangWatch(now, SharedBeat.PERIOD)
        if self._beat:
            self._beat.at = 0
        try:
            self.process = self._server.start(self._program, [self._config_file, *self._files])
        except OSError as error:
            self.process = None
            text = "%s cannot be started, tried again soon: %s"
            log.warning(text, self._process_name, error)

    def use(self, config_file: int) -> None:
        """Run with another configuration from now on: the process ends, and the next one has it."""
        if config_file == self._config_file or not self._has_plan:
            return
        self._config_file = config_file
        if self.process and self.process.poll() is None:
            self.process.send_signal(signal.SIGTERM)

    def stop(self, timeout: float) -> None:
        """End it; it has so long (s) to deliver or save what waits."""
        if self.process is None or self.process.poll() is not None:
            return
        self.process.send_signal(signal.SIGTERM)
        self.process.wait(timeout)
        self.process.send_signal(signal.SIGKILL)


def make_helpers(
    server: ForkServer,
    config: GuardConfig,
    config_file: int,
    slot_files: Sequence[int],
    bulk_port: ProcessPort,
) -> Iterator[HelperProcess]:
    """Yield what runs beside the guard: a dry run is one process."""
    if not config.options.get("dry_run"):
        recorder_port = ProcessPort()
        sides = (bulk_port.accepting_side, recorder_port.connecting_side)
        files = [side.fileno() for side in sides]
        yield HelperProcess(server, config_file, BULK, files=files, beat=SharedBeat.create())
        yield HelperProcess(
            server,
            config_file,
            INCIDENTS,
            files=[recorder_port.accepting_side.fileno()],
            has_plan=False,
            is_needed=recorder_port.has_connection,
        )
    if config.options.get("link"):
        yield HelperProcess(
            server, config_file, LINK, files=slot_files, beat=SharedBeat.create(), has_plan=False
        )


def stop_helpers(helpers: Sequence[HelperProcess]) -> None:
    """End them in their order: what the bulk process notes last is recorded and delivered."""
    until = time.monotonic() + _END_S
    for helper in helpers:
        helper.stop(max(_LEAST_S, until - time.monotonic()))
