"""A guard whose settings are changed while it runs: through a door of the test's own.

As a program it is that guard; its arguments are the plan, the master and the door.
"""

import json
import socket
import sys
from pathlib import Path

from harness import HERE

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.control_socket import ControlSocket
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.observations import observations_of
from rtron.guard.runner import INTERRUPTS, GraphPart, run_parts
from rtron.guard.settings.applier import SettingsApplier
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.planning.plan_file.loader import read_plan
from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import NodeSettings, Settings, build_streams
from rtron.wire.common.link_protocol import NewSettings, decode_to_guard, encode_to_guard


class GuardWithSettings:
    """Starts the guard of a plan, and changes its settings."""

    def __init__(self, ros1, plan):
        self.revision = 0
        self._door = ros1.folder / "door" / "settings"
        path = ros1.folder / "rtron.yaml"
        path.write_text(write_plan(plan))
        words = (sys.executable, __file__, path, ros1.uri, self._door)
        self._process = ros1.spawn(*words, PYTHONPATH=str(HERE))
        self._process.hurry()
        nodes = {f"/rtron/{stage.id}" for stream in build_streams(plan) for stage in stream.stages}
        ros1.wait_for_nodes(*nodes)

    def put(self, nodes=None, stop=None):
        """Put settings in force: by coordination node, what differs from the plan."""
        self.revision += 1
        given = {id: NodeSettings(**values) for id, values in (nodes or {}).items()}
        settings = Settings(revision=self.revision, nodes=given, stop=stop)
        answer = self._ask(encode_to_guard(NewSettings(settings=settings, now=0)).decode())
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
    plan, loop = read_plan(Path(plan)), EventLoop()
    transport = Ros1Transport(loop, master)
    host = Coordinator(transport, build_streams(plan), observations_of(plan))
    applying = SettingsApplier(plan, host, transport)

    def answer(_who, request):
        message = decode_to_guard(request["said"])
        applying.apply(message.settings, message.now)
        return {"applied": applying.revision}

    parts = [GraphPart(host.open, transport), ControlSocket(loop, Path(door), answer)]
    run_parts(loop, parts, until=INTERRUPTS)


if __name__ == "__main__":
    main()
