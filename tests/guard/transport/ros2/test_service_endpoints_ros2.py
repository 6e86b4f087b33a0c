"""A service of a node of the guard, and clients that do not know it yet."""

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")
from harness import LIMIT_S
from ros2_world import OnRos2

from rtron.guard.transport.ros2 import responses, service_calls
from rtron.vocabulary import SECOND

pytestmark = [
    pytest.mark.ros2,
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]
NAME, TYPE, EMPTY = "/lamp", "test_msgs/srv/Empty", b"\0\1\0\0\0"


@pytest.mark.parametrize(("failures", "timeout", "is_lost"), [(2, SECOND, False), (9, 0, True)])
def test_who_does_not_know_the_service_yet_is_answered_later_or_it_is_told(
    ros2, monkeypatch, caplog, failures, timeout, is_lost
):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.setattr(responses, "_RETRY_TIMEOUT", LIMIT_S * timeout)
    with OnRos2(ros2) as world:
        answers, attempts = [], []
        server = world.transport.create_server(
            NAME, NAME, TYPE, lambda request_id, _request: server.respond(request_id, EMPTY)
        )
        server.open()
        client = world.transport.create_client(
            "/nav", NAME, TYPE, lambda number, _response: answers.append(number)
        )
        world.until(lambda: client.is_available)
        send = server._calls._send_response

        def fail_first(*arguments):
            attempts.append(arguments)
            return service_calls._TIMED_OUT if len(attempts) <= failures else send(*arguments)

        server._calls._send_response = fail_first
        number = client.call(EMPTY)
        world.until(lambda: answers or server._retry.lost)
        assert answers == ([] if is_lost else [number])
        assert ("/lamp: an answer is lost" in caplog.text) is is_lost
