"""A guard whose settings are changed while it runs: through a door of the test's own.

As a program it is that guard; its arguments are the plan, the master and the door.
"""

import json
import socket
import sys
from pathlib import Path

from harness import HERE

from rtron.guard.core.control_socket import Control
from rtron.guard.core.coordinator import Host
from rtron.guard.core.event_loop import Loop
from rtron.guard.core.observations import senses_of
from rtron.guard.runner import run_host
from rtron.guard.settings.applier import Applying
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.planning.plan_file.loader import read_plan
from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import NodeSettings, Settings, streams
from rtron.wire.common.link_protocol import NewSettings, service_bytes, to_guard


class ChangingGuard:
    """Starts the guard of a plan, and changes its settings."""

    def __init__(self, ros1, plan):
        self.revision = 0
        self._door = ros1.folder / "door" / "settings"
        path = ros1.folder / "rtron.yaml"
        path.write_text(write_plan(plan))
        words = (sys.executable, __file__, path, ros1.uri, self._door)
        self._process = ros1.spawn(*words, PYTHONPATH=str(HERE))
        self._process.hurry()
        nodes = {f"/rtron/{stage.id}" for stream in streams(plan) for stage in stream.stages}
        ros1.wait_for_nodes(*nodes)

    def put(self, nodes=None, stop=None):
        """Put settings in force: by coordination node, what differs from the plan."""
        self.revision += 1
        given = {id: NodeSettings(**values) for id, values in (nodes or {}).items()}
        settings = Settings(revision=self.revision, nodes=given, stop=stop)
        answer = self._ask(service_bytes(NewSettings(settings=settings, now=0)).decode())
        assert answer == {"applied": self.revision}, self._process.log

    def _ask(self, said):
        with socket.socket(socket.AF_UNIX) as door:
            door.settimeout(60)
            door.connect(str(self._door))
            door.sendall(json.dumps({"said": said}).encode() + b"\n")
            door.shutdown(socket.SHUT_WR)
            return json.loads(door.makefile().read())


def main():
    plan, master, door = sys.argv[1:]
    plan, loop = read_plan(Path(plan)), Loop()
    transport = Ros1Transport(loop, master)
    host = Host(transport, streams(plan), senses_of(plan))
    applying = Applying(plan, host, transport)

    def answer(_who, request):
        message = to_guard(request["said"])
        applying.apply(message.settings, message.now)
        return {"applied": applying.revision}

    control = Control(loop, Path(door), answer)
    run_host(host, transport, loop)
    control.close()


if __name__ == "__main__":
    main()
