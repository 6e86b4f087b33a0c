"""Discovery takes time in proportion to the endpoints, also where everything meets in one topic."""

from time import process_time

import pytest
from app_graphs import AUTORACE, HOME
from reference_algorithm import naive_risks

from rtron.risks import discover_risks
from rtron.vocabulary import Direction, Endpoint, InteractionGraph

pytestmark = pytest.mark.timed

PUB, SUB = Direction.PUBLISH, Direction.SUBSCRIBE
TF = "tf2_msgs/TFMessage"


def seconds(graph: InteractionGraph, discover=discover_risks) -> float:
    def once() -> float:
        start = process_time()
        discover(InteractionGraph(app=graph.app, nodes=graph.nodes, endpoints=graph.endpoints))
        return process_time() - start

    return min(once() for _ in range(5))


@pytest.mark.parametrize("graph", [HOME, AUTORACE], ids=["home", "autorace"])
def test_an_app_takes_about_as_long_as_the_naive_reading(graph):
    assert seconds(graph) < 3 * seconds(graph, naive_risks)


def crowd(size: int) -> InteractionGraph:
    """Everybody publishes one topic of two, and everybody hears both."""
    ends = [(f"/n{i}", "/tf" if i % 2 else "/tf_static", PUB) for i in range(size)]
    ends += [(f"/n{i}", topic, SUB) for i in range(size) for topic in ("/tf", "/tf_static")]
    return _graph(ends)


def private_pairs(size: int) -> InteractionGraph:
    """Everybody hears one crowded topic and one of his own, so that no two hear the same."""
    ends = [(f"/p{i}", "/tf", PUB) for i in range(size)]
    ends += [(f"/n{i}", topic, SUB) for i in range(size) for topic in ("/tf", f"/{i}/tf")]
    return _graph(ends)


def hub(size: int) -> InteractionGraph:
    """One node publishes and hears everything."""
    return _graph([("/hub", f"/detect/{i}", (PUB, SUB)[i % 2]) for i in range(3 * size)])


def _graph(ends) -> InteractionGraph:
    made = (Endpoint(node=n, topic=t, type=TF, direction=d) for n, t, d in ends)
    return InteractionGraph(app="big", endpoints=tuple(made))


@pytest.mark.parametrize("shape", [crowd, private_pairs, hub])
def test_ten_times_the_endpoints_take_ten_times_as_long(shape):
    small, large = seconds(shape(500)), seconds(shape(5000))
    assert large < 30 * small
