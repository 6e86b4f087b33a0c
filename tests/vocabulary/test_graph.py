"""The indexes of an InteractionGraph."""

from hypothesis import given
from hypothesis import strategies as st

from rtron.vocabulary import Direction, Endpoint, InteractionGraph

endpoints = st.lists(
    st.builds(
        Endpoint,
        node=st.sampled_from(["/a", "/b", "/c"]),
        topic=st.sampled_from(["/x", "/y"]),
        direction=st.sampled_from(Direction),
    ),
    max_size=20,
).map(tuple)


@given(endpoints)
def test_an_index_gives_what_looking_through_all_endpoints_gives(endpoints):
    graph = InteractionGraph(app="app", endpoints=endpoints)
    publishes = [e for e in endpoints if e.direction is Direction.PUBLISH]
    subscribes = [e for e in endpoints if e.direction is Direction.SUBSCRIBE]
    for topic in ("/x", "/y", "/nobody"):
        assert graph.publishers(topic) == tuple(e for e in publishes if e.topic == topic)
        assert graph.subscribers(topic) == tuple(e for e in subscribes if e.topic == topic)
    for node in ("/a", "/b", "/c", "/nobody"):
        assert graph.published_by(node) == tuple(e for e in publishes if e.node == node)
        assert graph.subscribed_by(node) == tuple(e for e in subscribes if e.node == node)


def test_looking_something_up_does_not_change_a_graph():
    endpoint = Endpoint(node="/a", topic="/x", direction=Direction.PUBLISH)
    asked, other = (InteractionGraph(app="app", endpoints=(endpoint,)) for _ in range(2))
    asked.publishers("/x")
    assert asked == other
    assert repr(asked) == repr(other)


def test_each_direction_is_the_opposite_of_the_other():
    assert Direction.PUBLISH.opposite is Direction.SUBSCRIBE
    assert Direction.SUBSCRIBE.opposite is Direction.PUBLISH
