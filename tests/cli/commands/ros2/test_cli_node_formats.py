"""`rtron scan --format nodl` and `--format rosgraph`."""

import json

import pytest
import yaml

GRAPH = {
    "schema": "rtron.graph/1",
    "app": "robot",
    "ros": 2,
    "endpoints": [
        {"node": "/a", "topic": "/x", "direction": "publish", "type": "std_msgs/msg/Bool"},
        {"node": "/b", "topic": "/x", "direction": "subscribe", "type": "std_msgs/msg/Bool"},
    ],
    "clients": [{"node": "/b", "name": "/s", "type": "std_srvs/srv/Empty"}],
    "parameters": [{"node": "/b", "name": "rate", "value": 5}],
}


@pytest.fixture
def graph2(tmp_path):
    path = tmp_path / "graph2.json"
    path.write_text(json.dumps(GRAPH))
    return path


def test_nodl_is_a_stream_of_documents(rtron, graph2):
    ran = rtron("scan", graph2, "--format", "nodl")
    first, second = yaml.safe_load_all(ran.out)
    assert (ran.code, first["publishers"][0]["name"]) == (0, "/x")
    assert second["parameters"] == {"rate": {"type": "int", "default_value": 5}}
    assert second["service_clients"][0]["name"] == "/s"


def test_nodl_into_a_folder_is_a_file_for_each_node(rtron, graph2, tmp_path):
    folder = tmp_path / "nodes"
    folder.mkdir()
    ran = rtron("scan", graph2, "--format", "nodl", "-o", folder)
    assert (ran.code, ran.out) == (0, "")
    assert sorted(path.name for path in folder.iterdir()) == ["a.nodl.yaml", "b.nodl.yaml"]


def test_rosgraph_is_json_of_the_message(rtron, graph2):
    ran = rtron("scan", graph2, "--format", "rosgraph")
    assert [node["name"] for node in json.loads(ran.out)["nodes"]] == ["/a", "/b"]


@pytest.mark.parametrize("format", ["nodl", "rosgraph"])
def test_a_graph_of_ros1_has_no_such_shape(rtron, graph_file, format):
    ran = rtron("scan", graph_file, "--format", format)
    assert ran.code == 2
    assert "ROS 1" in ran.err


def test_clients_and_parameters_are_kept_in_a_graph(rtron, graph2):
    found = json.loads(rtron("scan", graph2, "--format", "graph").out)
    assert (found["clients"], found["parameters"]) == (GRAPH["clients"], GRAPH["parameters"])
