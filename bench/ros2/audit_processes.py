"""The processes of the audit on ROS 2: `python -m bench.ros2.audit_processes WHAT ...`."""

import signal
import sys
import time
from pathlib import Path

from geometry_msgs.msg import Twist

from bench.common.pubsub import PUBLISHER
from bench.common.unsupervised_guard import run_coordinator
from bench.ros2.audit import DRIVER, FLOW, OPEN, OUT
from rtron.guard.audit.common.alarm_response import AlarmResponse
from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.middleware import Ros2Middleware
from rtron.guard.transport.ros2.middleware import Ros2Transport
from rtron.planning.plan_file.loader import read_plan
from rtron.vocabulary import build_streams
from rtron.wire.ros2.discovery_tuning import enable_fast_announcements
from rtron.wire.ros2.session import Ros2Session

_PERIOD_S = 0.001
_SPEAK_S = 0.1
_DECODED = False


def main() -> None:
    """Be the `guard` of a plan, the `app` around it, or `intrude` as a node on a topic."""
    what, *arguments = sys.argv[1:]
    signal.signal(signal.SIGTERM, lambda *_: sys.exit())
    if what == "guard":
        _guard(Path(arguments[0]))
        return
    session = Ros2Session()
    try:
        _app(session) if what == "app" else _intrude(session, *arguments)
    finally:
        session.close()


def _guard(path: Path) -> None:
    enable_fast_announcements()
    plan, loop = read_plan(path), EventLoop()
    transport = Ros2Transport(loop, Ros2Session())
    host = Coordinator(transport, build_streams(plan))
    response = AlarmResponse(host, transport, plan.audit.on_foreign, dry_run=False)
    middleware = Ros2Middleware(plan, transport, loop)
    audit = (middleware.create_listener(response), middleware.create_auditor(response, None))
    run_coordinator(host, transport, loop, *audit)


def _app(session: Ros2Session) -> None:
    """Speak as the planned publisher, listen as the successor, and say when the way is open."""
    publisher = session.node(PUBLISHER).create_publisher(Twist, FLOW, 10)
    listener = session.node(DRIVER).create_subscription(Twist, OUT, lambda _: None, 10)
    with listener.handle:
        while listener.handle.take_message(Twist, _DECODED) is None:
            publisher.publish(Twist())
            time.sleep(_PERIOD_S)
    sys.stderr.write(f"{OPEN}\n")
    sys.stderr.flush()
    while True:
        publisher.publish(Twist())
        time.sleep(_SPEAK_S)


def _intrude(session: Ros2Session, node: str, topic: str) -> None:
    """Publish a topic; say when somebody has begun to listen, and go on until told to end."""
    publisher = session.node(node).create_publisher(Twist, topic, 10)
    while not publisher.get_subscription_count():
        time.sleep(_PERIOD_S)
    sys.stdout.write(f"{time.monotonic_ns()}\n")
    sys.stdout.flush()
    while True:
        publisher.publish(Twist())
        time.sleep(_PERIOD_S)


if __name__ == "__main__":
    main()
