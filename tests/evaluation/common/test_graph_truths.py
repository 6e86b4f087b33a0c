"""What a truth and a graph may name in two ways."""

from evaluation.common.graph_truths import GraphTruth, Triple
from rtron.vocabulary import Direction, Endpoint, Evidence, InteractionGraph, Node, Service


def _endpoint(node, topic, direction=Direction.PUBLISH, file=""):
    return Endpoint(
        node=node, topic=topic, direction=direction, evidence=(Evidence(file=file, line=1),)
    )


NODELETS = GraphTruth(
    {
        "nodes": [
            {"name": "/manager", "third_party": True, "services": [{"service": "/manager/list"}]},
            {
                "name": "/camera",
                "manager": "/manager",
                "publishes": [{"topic": "/image"}],
                "clients": [{"service": "/manager/load_nodelet"}],
            },
            {"name": "/filter", "manager": "/manager", "subscribes": [{"topic": "/image"}]},
        ]
    }
)


def test_endpoints_of_a_nodelet_count_at_its_manager():
    graph = InteractionGraph(
        app="",
        nodes=(Node(name="/camera"), Node(name="/manager")),
        endpoints=(
            _endpoint("/manager", "/image"),
            _endpoint("/manager", "/image", Direction.SUBSCRIBE),
            _endpoint("/manager", "/depth"),
        ),
        services=(Service(node="/manager", name="/manager/list", type=""),),
        clients=(Service(node="/camera", name="/manager/load_nodelet", type=""),),
    )
    score = NODELETS.score(graph)
    assert score.found == score.live
    assert len(score.live) == 4
    assert score.wrong == {Triple("/manager", "publishes", "/depth")}
    own = NODELETS.score(graph, own_only=True)
    assert own.found == own.live
    assert Triple("/manager", "services", "/manager/list") not in own.reported
    assert own.wrong == score.wrong


LISTENER = GraphTruth(
    {
        "nodes": [
            {
                "name": "/planner",
                "subscribes": [
                    {
                        "topic": "/tf",
                        "evidence": "src/planner.cpp:7",
                        "own_node": "listener_impl_<address>",
                    }
                ],
            }
        ]
    }
)


def test_what_a_library_puts_on_a_node_of_its_own_may_be_found_there():
    def found(node, file):
        endpoints = (_endpoint(node, "/tf", Direction.SUBSCRIBE, file),)
        return len(LISTENER.score(InteractionGraph(app="", endpoints=endpoints)).found)

    assert found("/listener_impl_{id}", "/app/src/planner.cpp") == 1
    assert found("/planner", "/app/src/planner.cpp") == 1
    assert found("/listener_impl_{id}", "/app/src/other.cpp") == 0
    assert found("/other_{id}", "/app/src/planner.cpp") == 0
