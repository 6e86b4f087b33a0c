"""Pairs: what is ignored, and how an action becomes one pair."""

import pytest

from evaluation.ros1.architecture import (
    Architecture,
    graph_architecture,
    is_ignored,
    with_actions,
    without_ignored,
    without_nodes,
)
from rtron.vocabulary import Direction, Endpoint, InteractionGraph, Node, Resolution, Service

ANSWERS = ("feedback", "result", "status")
ORDERS = ("goal", "cancel")


def pairs(node, *names):
    return frozenset((node, name) for name in names)


def action(node, space, parts):
    return pairs(node, *(f"{space}/{part}" for part in parts))


@pytest.mark.parametrize(
    ("name", "ignored"),
    [
        ("/clock", True),
        ("/a/clock", False),
        ("/tf", True),
        ("/tf2", False),
        ("/diagnostics", True),
        ("/m/bond", True),
        ("/bonded", False),
        ("/m/list", False),
        ("/my_manager/list", True),
        ("/c/list_controllers", True),
        ("/a/parameter_description", True),
        ("/a/parameter_updates", True),
        ("/a/set_parameters", True),
        ("/a/set_parameters_x", False),
    ],
)
def test_the_ignore_list(name, ignored):
    assert is_ignored(name) is ignored


def test_ignored_names_leave_topics_and_services_and_no_node():
    whole = Architecture(
        nodes=pairs("/clock", "/clock"),
        publishers=pairs("/a", "/tf", "/scan"),
        subscribers=pairs("/a", "/clock"),
        services=pairs("/a", "/a/set_parameters", "/go"),
    )
    left = without_ignored(whole)
    assert left.nodes == whole.nodes
    assert (left.publishers, left.subscribers) == (pairs("/a", "/scan"), frozenset())
    assert left.services == pairs("/a", "/go")


def test_an_action_is_one_pair_on_each_side():
    found = with_actions(
        Architecture(
            publishers=action("/s", "/move", ANSWERS) | action("/c", "/move", ORDERS),
            subscribers=action("/s", "/move", ORDERS) | action("/c", "/move", ANSWERS),
        )
    )
    assert found.action_servers == {("/s", "/move")}
    assert found.action_clients == {("/c", "/move")}
    assert found.publishers == found.subscribers == frozenset()


@pytest.mark.parametrize("lacking", [*ANSWERS, *ORDERS])
def test_four_topics_are_no_action(lacking):
    answers = action("/s", "/move", [part for part in ANSWERS if part != lacking])
    orders = action("/s", "/move", [part for part in ORDERS if part != lacking])
    whole = Architecture(publishers=answers, subscribers=orders)
    assert with_actions(whole) == whole


def test_a_server_that_commands_itself_keeps_the_goal_it_publishes():
    published = action("/s", "/move", (*ANSWERS, "goal"))
    found = with_actions(
        Architecture(publishers=published, subscribers=action("/s", "/move", ORDERS))
    )
    assert found.publishers == {("/s", "/move/goal")}


def test_declared_actions_are_taken_as_they_are():
    whole = Architecture(
        publishers=action("/s", "/a", ANSWERS) | action("/s", "/b", ANSWERS),
        subscribers=action("/s", "/a", ORDERS) | action("/s", "/b", ORDERS),
        action_servers=frozenset({("/s", "/a")}),
    )
    found = with_actions(whole)
    assert found.action_servers == {("/s", "/a")}
    assert found.publishers == action("/s", "/b", ANSWERS)


def test_a_graph_gives_its_pairs_without_symbolic_and_unobserved_names():
    def end(topic, direction, resolution=Resolution.LITERAL):
        return Endpoint(node="/a", topic=topic, direction=direction, resolution=resolution)

    graph = InteractionGraph(
        app="x",
        nodes=(Node(name="/a"), Node(name="/b")),
        endpoints=(
            end("/scan", Direction.PUBLISH, Resolution.MODEL),
            end("/{~x}", Direction.PUBLISH, Resolution.SYMBOLIC),
            end("/rosout", Direction.PUBLISH),
            end("/map", Direction.SUBSCRIBE),
        ),
        services=(
            Service(node="/a", name="/go"),
            Service(node="/a", name="/a/get_loggers"),
            Service(node="/a", name="/{?}/go"),
        ),
    )
    found = graph_architecture(graph)
    assert found.nodes == {("/a", "/a"), ("/b", "/b")}
    assert found.publishers == {("/a", "/scan")}
    assert found.subscribers == {("/a", "/map")}
    assert found.services == {("/a", "/go")}


def test_a_node_goes_with_all_it_has():
    whole = Architecture(
        nodes=pairs("/a", "/a") | pairs("/b", "/b"),
        publishers=pairs("/a", "/x") | pairs("/b", "/x"),
        services=pairs("/a", "/go"),
    )
    left = without_nodes(whole, ["/a"])
    assert left == Architecture(nodes=pairs("/b", "/b"), publishers=pairs("/b", "/x"))
