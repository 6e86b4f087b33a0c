"""The score against a truth that was made by hand, alone and beside its script."""

import json
import os
import re
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from evaluation.ros1.manual_truth import read_truth
from rtron.vocabulary import Direction, Endpoint, InteractionGraph, Node, Resolution, Trust

TRUTH = """
nodes:
- name: /own
  publishes:
  - {topic: /cmd, type: geometry_msgs/Twist}
  - {topic: /dead, type: std_msgs/Bool, live: false}
  - {topic: /both, live: false}
  - {topic: /both}
  subscribes:
  - {topic: /scan, type: [sensor_msgs/LaserScan, x/Y]}
  - {topic: /tf, implicit: tf2_ros}
  - {topic: /bond}
- name: /theirs
  third_party: true
  publishes:
  - {topic: /scan, type: sensor_msgs/LaserScan}
"""


@pytest.fixture
def truth(tmp_path):
    path = tmp_path / "truth.yaml"
    path.write_text(TRUTH)
    return read_truth(path)


def publishes(node, topic, **more):
    return Endpoint(node=node, topic=topic, direction=Direction.PUBLISH, **more)


def graph_of(*endpoints):
    nodes = tuple(Node(name=name) for name in dict.fromkeys(end.node for end in endpoints))
    return InteractionGraph(app="x", nodes=nodes, endpoints=endpoints)


def test_the_graph_of_the_truth_scores_full(truth):
    found = truth.score(truth.graph())
    assert (found.precision, found.recall, found.nodes, found.matched_nodes) == (1, 1, 2, 2)
    assert list(found.differences()) == []


def test_the_graph_of_the_truth_has_types_and_trust(truth):
    graph = truth.graph()
    assert [node.trust for node in graph.nodes] == [Trust.OWN, Trust.THIRD_PARTY]
    assert {e.type for e in graph.endpoints if e.topic == "/scan"} == {"sensor_msgs/LaserScan"}


def test_what_is_dead_extra_or_missed_is_said(truth):
    found = truth.score(graph_of(publishes("/own", "/dead"), publishes("/own", "/new")))
    assert found.precision == 0
    assert list(found.differences()) == [
        "MISSED /own publish /both",
        "MISSED /own publish /cmd",
        "MISSED /own subscribe /scan",
        "MISSED /own subscribe /tf",
        "MISSED /theirs publish /scan",
        "DEAD   /own publish /dead",
        "EXTRA  /own publish /new",
    ]


def test_what_is_live_at_another_place_is_not_dead(truth):
    assert truth.score(graph_of(publishes("/own", "/both"))).precision == 1


@pytest.mark.parametrize(
    "endpoint",
    [
        publishes("/unlisted", "/x"),
        publishes("/own", "/{~x}", resolution=Resolution.SYMBOLIC),
        publishes("/own", "/rosout"),
        publishes("/own", "/clock"),
        publishes("/own", "/own/transition_event"),
    ],
)
def test_what_the_truth_does_not_list_is_not_held_against_a_graph(truth, endpoint):
    assert truth.score(graph_of(endpoint)).reported == frozenset()


def test_first_party_and_explicit_narrow_both_sides(truth):
    graph = truth.graph()
    own = truth.score(graph, first_party=True)
    assert (own.nodes, len(own.live), own.precision) == (1, 4, 1)
    assert own.hits_of(Direction.PUBLISH) == (2, 2)
    assert own.hits_of(Direction.SUBSCRIBE) == (2, 2)
    marked = tuple(replace(end, implicit=end.topic == "/tf") for end in graph.endpoints)
    explicit = truth.score(replace(graph, endpoints=marked), explicit=True)
    assert (len(explicit.live), explicit.precision, explicit.recall) == (4, 1, 1)


@pytest.mark.skipif("RTRON_DATA" not in os.environ, reason="RTRON_DATA names no folder of data")
@pytest.mark.parametrize("flag", ["", "--first-party", "--explicit"])
def test_a_damaged_graph_scores_as_the_script_scores_it(tmp_path, flag):
    folder = Path(os.environ["RTRON_DATA"]) / "groundtruth"
    truth = read_truth(folder / "autorace.yaml")
    whole = truth.graph()
    graph = replace(whole, endpoints=(*whole.endpoints[::2], publishes("/amcl", "/new")))
    rows = [
        {
            "node": end.node,
            "topic": end.topic,
            "direction": end.direction.value,
            "resolution": end.resolution.value,
        }
        for end in graph.endpoints
    ]
    path = tmp_path / "graph.json"
    path.write_text(
        json.dumps({"nodes": [{"name": node.name} for node in graph.nodes], "endpoints": rows})
    )
    script = [sys.executable, str(folder / "score_hand.py"), str(folder / "autorace.yaml")]
    command = [*script, str(path), *filter(None, [flag])]
    said = subprocess.run(command, capture_output=True, text=True, check=False).stdout
    found = truth.score(graph, first_party="first" in flag, explicit="explicit" in flag)
    ours = (found.matched_nodes, found.nodes, len(found.live), found.precision, found.recall)
    numbers = re.match(r"nodes (\d+)/(\d+) live (\d+) precision (\S+) recall (\S+)", said)
    assert tuple(map(float, numbers.groups())) == pytest.approx(ours, abs=6e-4)
