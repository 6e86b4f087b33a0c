"""The part of a bridge that hears persons: real requests and real sockets, without ROS."""

import threading
from contextlib import suppress

from rtron.bridge.protocol.approvals import Approvals
from rtron.bridge.rights.rights_file import parse_rights
from rtron.bridge.server.runner import hearing_persons
from rtron.errors import WireError
from rtron.guard.core.event_loop import EventLoop

GOAL = {"pose": {"position": {"x": 1, "y": 3}}}
APPROVERS = "approvers: {roles: [end_user], names: [dora]}"


class ApprovingBridge:
    """Runs in a thread of its own while it is entered."""

    def __init__(self, app="app"):
        self.loop, self.approvals = EventLoop(), Approvals()
        self._app = app
        self._rights = parse_rights(f"schema: rtron.bridge/1\nclients: []\n{APPROVERS}\n")

    def __enter__(self):
        self._hearing = hearing_persons(self.loop, self.approvals, self._app, self._rights)
        self._hearing.__enter__()
        self._thread = threading.Thread(target=self.loop.run)
        self._thread.start()
        return self

    def __exit__(self, *_):
        self.loop.post(self.loop.stop)
        self._thread.join()
        self._hearing.__exit__(None, None, None)
        self.loop.close()

    def ask(self, content=GOAL, client="assistant", what="publish /goal"):
        """Let a client try to send something; return the reason, or "" if it passes."""
        try:
            self.approvals.check(client, what, content, self.loop.now())
        except WireError as error:
            return str(error)
        return ""

    def flood(self, clients, contents):
        for client in clients:
            for content in contents:
                with suppress(WireError):
                    self.approvals.check(client, "publish /goal", content, self.loop.now())
