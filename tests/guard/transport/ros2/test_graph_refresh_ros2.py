"""Whether the graph that the guard knows was asked for at the last refresh."""

from contextlib import closing

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.transport.ros2.middleware import Ros2Transport
from rtron.vocabulary import Direction
from rtron.wire.ros2.session import Ros2Session

pytestmark = [
    pytest.mark.ros2,
    pytest.mark.filterwarnings("ignore:module 'sre_:DeprecationWarning"),
]
FAILURE = 1
"""What rcl returns if a query fails (RCL_RET_ERROR)."""


@pytest.fixture
def graph(ros2, monkeypatch):
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    with (
        closing(Ros2Session(domain=ros2.domain)) as session,
        closing(EventLoop()) as loop,
        closing(Ros2Transport(loop, session).graph) as graph,
    ):
        graph.watch("/topic")
        yield graph


def test_a_query_that_fails_makes_the_refresh_none(graph, monkeypatch):
    assert not graph.is_current
    graph.refresh()
    assert graph.is_current
    functions = graph._graph_query._query_functions
    with monkeypatch.context() as patched:
        patched.setitem(functions, Direction.SUBSCRIBE, lambda *_: FAILURE)
        graph.refresh()
        assert not graph.is_current
    graph.query("/topic")
    assert not graph.is_current, "one topic is not all"
    graph.refresh()
    assert graph.is_current
