"""The supervisor: it watches the guard, stops the robot when the guard cannot, and restarts it."""

import json
import logging
import os
import signal
from collections.abc import Iterable
from functools import partial

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.log_throttle import LogThrottle
from rtron.guard.core.printable import printable
from rtron.guard.supervision.delivery_watch import DeliveryWatch
from rtron.guard.supervision.fork_server import START_FAILED, UNKNOWN_END, ForkServer
from rtron.guard.supervision.guard_config import GuardConfig, longest_ramp, stopped_streams
from rtron.guard.supervision.guard_name import (
    SUPERVISOR,
    answer_name,
    await_former_guard,
    take_name,
)
from rtron.guard.supervision.guard_process import GuardProcess, spawn_guard
from rtron.guard.supervision.helper_process import make_helpers, stop_helpers
from rtron.guard.supervision.plan_trial import PlanTrial, make_plan_slot
from rtron.guard.supervision.programs import JOB_CONTROL_SIGNALS, TERMINATION_SIGNALS
from rtron.guard.supervision.shared_memory import GuardMemory, StatusWord
from rtron.guard.supervision.stream_brakes import StreamBrakes
from rtron.guard.supervision.supervisor_fsm import (
    OK,
    OUT_OF_MEMORY,
    GuardObservation,
    GuardPhase,
    SupervisorAction,
    SupervisorFsm,
)
from rtron.guard.supervision.watchdog import BEAT_PERIOD, SchedulingDelay, Watchdog
from rtron.guard.system.process_port import ProcessPort
from rtron.guard.transport.factory import open_transport
from rtron.vocabulary import SECOND
from rtron.wire.common.systemd import take_notifier

log = logging.getLogger(__name__)

_SPARE_AFTER = SECOND
_SPARE_RETRY = 5 * SECOND
_FOR_PLAN = "made place for another plan"
_FAILURES = {
    OUT_OF_MEMORY: "ran out of memory",
    START_FAILED: "cannot be started",
    UNKNOWN_END: "has ended, and nobody knows how",
}


class Supervisor:
    """Does what the state machine (`SupervisorFsm`) decides, until that is to leave."""

    def __init__(
        self, config: GuardConfig, config_file: int, loop: EventLoop, server: ForkServer
    ) -> None:
        """Prepare to start a guard, once one that runs without a supervisor has ended.

        SourceError if a guard of this user is supervised on the master.
        """
        streams = stopped_streams(config.plan)
        self._stream_count = len(streams)
        self._server = server
        self._name = take_name(SUPERVISOR, config.master)
        self._had_former_guard = await_former_guard(config.master, longest_ramp(config.plan))
        self._guard: GuardProcess | None = None
        self._plan_trial = _plan_trial(config, config_file)
        self._loop = loop
        self._transport = open_transport(config.plan, config.master, loop)
        self._transport.set_shutdown_handler(self._refuse_shutdown)
        self._log_throttle = LogThrottle()
        self._systemd = take_notifier(os.environ)
        self._memory = memory = GuardMemory.create(self._stream_count)
        self._brakes = StreamBrakes(streams, self._transport, memory)
        self._watchdog = Watchdog(loop.now())
        self._delay = SchedulingDelay(loop.now())
        self._delivery = DeliveryWatch(self._transport, loop.now())
        self._fsm = SupervisorFsm(loop.now(), config.plan.supervision)
        self._bulk_port = ProcessPort()
        self._helpers = list(
            make_helpers(server, config, config_file, self._plan_trial.slot_files, self._bulk_port)
        )
        self._spare: GuardProcess | None = None
        self._spare_due = 0
        self._is_spare_ready = False
        self._failure = self._failure_report = ""
        self._code = OK
        self._is_leaving = self._is_end_requested = self._skips_final_stop = False
        if self._name:
            answer_name(loop, self._name)
        loop.watch(server.connection, self._on_server, lambda error: self._on_server_lost())

    def run(self) -> int:
        """Supervise until told to end, or until the guard ends in order; return the exit code."""
        self._handle_signals()
        if self._had_former_guard:  # nobody knows whether it has stopped the robot
            log.warning("a guard was there without its supervisor: the robot is stopped")
            self._brakes.brake("the former guard may not have stopped it", self._loop.now())
        self._tick()
        self._brakes.prepare()  # while the guard is starting
        self._loop.run()
        if self._spare:
            self._spare.discard()
        stop_helpers(self._helpers)
        self._transport.close()
        self._loop.close()
        return self._code or self._fsm.code

    def _handle_signals(self) -> None:
        """End with the terminal, unless its end was ignored before (nohup(1))."""
        for number in JOB_CONTROL_SIGNALS:
            signal.signal(number, signal.SIG_IGN)
        for number in (*TERMINATION_SIGNALS, signal.SIGTERM):
            if number != signal.SIGHUP or signal.getsignal(number) != signal.SIG_IGN:
                signal.signal(number, lambda number, _: self._loop.post(partial(self._end, number)))

    def _tick(self) -> None:
        now = self._loop.now()
        self._loop.call_at(now + BEAT_PERIOD, self._tick)
        self._memory[StatusWord.SUPERVISOR_BEAT] = now
        self._server.end_if_hung(now)
        try:
            self._watch_guard(now)
        finally:  # whatever fails there, the robot is stopped
            is_braking = self._brakes.tick(now)
        if self._is_leaving and (self._skips_final_stop or not is_braking):
            self._loop.stop()

    def _watch_guard(self, now: int) -> None:
        silence = self._watchdog.update(now, self._memory[StatusWord.GUARD_BEAT])
        is_serving, is_leaving = (
            bool(self._memory[word]) for word in (StatusWord.SERVING, StatusWord.LEAVING)
        )
        delay = self._delay.update(now)
        undelivered = self._delivery.tick(now)
        observation = GuardObservation(silence, is_serving, is_leaving, delay, undelivered)
        actions = self._fsm.tick(now, observation)
        self._memory[StatusWord.UNDELIVERED] = self._fsm.is_undelivered
        self._memory[StatusWord.UNWATCHED] = self._delivery.is_unwatched
        self._perform(actions, now)
        self._reap(now)
        self._prepare_spare(now)
        self._follow_plan(now)
        is_well = self._fsm.phase is GuardPhase.SERVING and not self._delivery.is_unwatched
        self._systemd.report(now, f"guard {self._fsm.phase.name.lower()}", is_well=is_well)
        if self._memory[StatusWord.SERVING] and not self._is_leaving:
            self._tick_helpers(now)

    def _tick_helpers(self, now: int) -> None:
        for helper in self._helpers:
            helper.tick(now)

    def _perform(self, actions: Iterable[SupervisorAction], now: int) -> None:
        for action in actions:
            match action:
                case SupervisorAction.SPAWN:
                    self._spawn(now)
                case SupervisorAction.BRAKE:
                    self._brake(now)
                case SupervisorAction.RELEASE:
                    log.info("the guard guards")
                    self._brakes.release()
                case SupervisorAction.TERMINATE:
                    self._send_signal(signal.SIGTERM)
                case SupervisorAction.KILL:
                    self._send_signal(signal.SIGKILL)
                case SupervisorAction.LEAVE:
                    self._is_leaving = True
                    self._brakes.release()

    def _spawn(self, now: int) -> None:
        guard = self._take_spare() or self._try_spawn("no guard can be started")
        if guard is None:
            self._fsm.start_failed(now)
            return
        self._plan_trial.begin()
        for helper in self._helpers:
            helper.use(self._plan_trial.config_file)
        guard.memory[StatusWord.SUPERVISOR_BEAT] = now
        guard.memory.supervisor_participant.write(self._transport.participant)
        failure_report = (
            json.dumps({"why": self._failure_report}).encode() if self._failure_report else b""
        )
        guard.begin(self._memory.handover_state.read()[1], failure_report)
        self._memory, former = guard.memory, self._memory
        self._brakes.follow(self._memory)
        former.close()
        self._watchdog = Watchdog(now)
        self._delivery.reset(now)
        self._guard = guard
        self._watch_connection(guard)

    def _take_spare(self) -> GuardProcess | None:
        """Return the guard that waits, if it lives."""
        spare, self._spare = self._spare, None
        if spare and spare.exit_code() is not None:
            spare.discard()
            return None
        if spare and spare.memory[StatusWord.READY]:
            self._fsm.spare_taken()
        return spare

    def _try_spawn(self, failure: str) -> GuardProcess | None:
        """Start a guard; None if the system has nothing left for it now."""
        try:
            port, config_file = self._bulk_port.connecting_side, self._plan_trial.config_file
            return spawn_guard(self._server, config_file, port, self._stream_count)
        except OSError as error:
            log.warning("%s, tried again soon: %s", failure, error)
            return None

    def _prepare_spare(self, now: int) -> None:
        """Have another guard ready, when this one has guarded for a moment."""
        serving_since = self._memory[StatusWord.SERVING]
        is_stable = (
            self._fsm.phase is GuardPhase.SERVING
            and serving_since
            and now - serving_since > _SPARE_AFTER
        )
        if is_stable and self._spare is None and now >= self._spare_due:
            self._spare_due = now + _SPARE_RETRY
            self._spare = self._try_spawn("the next guard cannot be made ready")
            self._is_spare_ready = False
        elif self._spare:
            self._watch_spare(self._spare)

    def _watch_spare(self, spare: GuardProcess) -> None:
        """See when the guard that waits is ready; replace one that has ended."""
        if spare.exit_code() is not None:
            log.warning("the next guard has ended while it waited; another one is made ready")
            spare.discard()
            self._spare = None
        elif not self._is_spare_ready and spare.pid and spare.memory[StatusWord.READY]:
            self._is_spare_ready = True
            log.info("the next guard is ready, process %d", spare.pid)

    def _follow_plan(self, now: int) -> None:
        """Let a guard with another plan take the place of the one that runs, once it is ready."""
        serving_since = self._memory[StatusWord.SERVING]
        if serving_since and self._fsm.phase is GuardPhase.SERVING:
            self._plan_trial.watch(now - serving_since)
        if self._plan_trial.take(now):
            log.info("the next guard gets another plan")
            self._drop_spare()
        elif self._plan_trial.give_up(now):
            log.error("no guard gets ready for another plan: the former one stays in force")
            self._drop_spare()
        if self._plan_trial.is_prepared and self._is_spare_ready and self._fsm.replace_guard():
            self._failure = _FOR_PLAN
            self._send_signal(signal.SIGKILL)

    def _drop_spare(self) -> None:
        """Do without the guard that waits: it has a plan that is not to come into force."""
        if self._spare:
            self._spare.send_signal(signal.SIGKILL)
            self._spare.discard()
        self._spare, self._spare_due, self._is_spare_ready = None, 0, False

    def _watch_connection(self, guard: GuardProcess) -> None:
        self._loop.watch(
            guard.connection,
            lambda: self._on_connection_lost(guard, "its connection has ended"),
            lambda error: self._on_connection_lost(guard, str(error)),
        )

    def _on_connection_lost(self, guard: GuardProcess, why: str) -> None:
        log.debug("the guard is lost: %s", why)
        self._loop.forget(guard.connection)
        now = self._loop.now()
        self._perform(self._fsm.connection_lost(now), now)

    def _brake(self, now: int) -> None:
        """Stop the robot."""
        self._brakes.brake("the guard does not answer", now)
        if not self._memory[StatusWord.LEAVING]:
            log.error("the guard %s: the robot is stopped", self._guard_state())

    def _guard_state(self) -> str:
        """Return what is wrong with the guard."""
        if self._fsm.phase is GuardPhase.LOST:
            return "is gone"
        return "does not deliver" if self._fsm.is_undelivered else "stands still"

    def _send_signal(self, number: int) -> None:
        if self._fsm.phase is GuardPhase.KILLED and self._failure != _FOR_PLAN:
            is_deaf = self._fsm.is_undelivered
            log.error(
                "the guard %s: it is killed",
                "delivers nothing" if is_deaf else "stands still, or does not end",
            )
            self._failure = f"{'delivered nothing' if is_deaf else 'stood still'} and was killed"
        if self._guard:
            self._guard.send_signal(number)

    def _reap(self, now: int) -> None:
        """See whether the guard that was lost has ended, and what comes next."""
        if self._guard is None or self._fsm.phase is not GuardPhase.LOST:
            return
        code = self._guard.exit_code()
        if code is None:
            return
        self._guard = None
        self._perform(self._fsm.guard_ended(now, code), now)
        self._report_end(code, now)

    def _report_end(self, code: int, now: int) -> None:
        failure, self._failure = self._failure or _exit_text(code), ""
        if self._plan_trial.guard_ended(code):
            log.error("the guard %s with another plan: the former one is in force again", failure)
            self._drop_spare()
        if failure == _FOR_PLAN:
            log.warning("the guard made place for one with another plan")
            self._failure_report = ""
        elif self._fsm.phase is GuardPhase.WAITING:
            wait = max(0, self._fsm.restart_due - now) / SECOND
            log.error("the guard %s; the next one begins in %.2g s", failure, wait)
            if code != START_FAILED:
                self._failure_report = f"the guard before {failure}"

    def _end(self, number: int) -> None:
        """End; who says so twice does not want to wait until the robot is at rest.

        A terminal's end is told twice, by the shell and the kernel, or beside a SIGTERM.
        """
        now = self._loop.now()
        self._systemd.stopping()
        if number != signal.SIGHUP:
            self._skips_final_stop = self._is_end_requested
            self._is_end_requested = True
        self._perform(self._fsm.shut_down(now), now)

    def _on_server(self) -> None:
        if not self._server.receive():
            self._on_server_lost()

    def _on_server_lost(self) -> None:
        """End: no guard could take the place of this one."""
        self._loop.forget(self._server.connection)
        self._code = os.EX_OSERR
        log.error("what starts the guard's processes is gone: the guard ends, start it again")
        self._perform(self._fsm.shut_down(self._loop.now()), self._loop.now())
        if self._guard and not self._guard.pid:  # nobody can tell it to end
            self._on_connection_lost(self._guard, "nobody knows whether it was started")

    def _refuse_shutdown(self, node: str, reason: str) -> None:
        """Go on: what stops the robot is not ended over the network."""
        if self._log_throttle.allows(node, self._loop.now()):
            log.error("%s was told to shut down and does not: %s", node, printable(reason))


def _plan_trial(config: GuardConfig, config_file: int) -> PlanTrial:
    link = config.options.get("link")
    return PlanTrial(config_file, make_plan_slot() if link and link.plans else None)


def _exit_text(code: int) -> str:
    """Return what became of a process."""
    if code < 0:
        return f"was killed by {signal.Signals(-code).name}"
    return _FAILURES.get(code, f"ended with exit code {code}")
