"""Guards on the real link that answer settings by themselves."""

from contextlib import ExitStack
from threading import Thread

from collector_server import hello, send_message
from controller_setup import plan
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from rtron.vocabulary import Alarm, AlarmKind, GuardState
from rtron.wire.common.link_protocol import Applied, NewSettings, StateReport, decode_to_guard


class AnsweringGuard:
    """A robot's guard; one that `is_bad` has an alarm while any node is changed."""

    def __init__(self, port, robot, headers):
        self.robot, self.is_bad = robot, False
        url, self._open = f"ws://127.0.0.1:{port}/link/v1", ExitStack()
        link = connect(url, additional_headers=headers, compression=None, proxy=None)
        self._socket = self._open.enter_context(link)
        send_message(self._socket, hello(plan=plan(), app="small", run=robot))
        self._thread = Thread(target=self._answer, daemon=True)
        self._thread.start()

    def show_problem(self):
        """Have an alarm, whatever is set."""
        self._tell_state(0, is_alarmed=True)

    def close(self):
        """End the connection."""
        self._open.close()
        self._thread.join(60)

    def _answer(self):
        try:
            for frame in self._socket:
                message = decode_to_guard(frame)
                if isinstance(message, NewSettings):
                    self._take(message.settings)
        except ConnectionClosed:
            return

    def _take(self, settings):
        applied = Applied(revision=settings.revision, plan=settings.plan)
        send_message(self._socket, applied)
        is_changed = bool(settings.nodes or settings.plan)
        self._tell_state(settings.revision, is_alarmed=self.is_bad and is_changed)

    def _tell_state(self, revision, *, is_alarmed):
        alarms = (Alarm(kind=AlarmKind.DRIFT, reason="it drifts"),) if is_alarmed else ()
        state = GuardState(at=0, revision=revision, alarms=alarms)
        send_message(self._socket, StateReport(state=state))
