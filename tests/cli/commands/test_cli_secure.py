"""`rtron secure`: a keystore from plan and graph, what differs, and SROS2's policy."""

import json
from types import SimpleNamespace
from xml.etree import ElementTree as ET

import pytest
from ros2_plans import driving, written

from rtron.cli.commands.secure import _complete_enclave
from rtron.sources.graph_json import graph_to_json
from rtron.vocabulary import Direction, Endpoint, InteractionGraph, Node

TWIST = "geometry_msgs/msg/Twist"


def graph_of(*topics, **more):
    ends = [
        Endpoint(node="/nav", topic="/cmd_vel", direction=Direction.PUBLISH, type=TWIST),
        Endpoint(node="/driver", topic="/cmd_vel", direction=Direction.SUBSCRIBE, type=TWIST),
        *(Endpoint(node="/nav", topic=each, direction=Direction.PUBLISH) for each in topics),
    ]
    return json.dumps(
        graph_to_json(InteractionGraph(app="a", ros=2, endpoints=tuple(ends), **more))
    )


@pytest.fixture
def secure(rtron, tmp_path):
    """Return a function that runs the command on an app of two nodes."""
    plan, graph = tmp_path / "rtron.yaml", tmp_path / "graph.json"
    plan.write_text(written(driving("nav")))
    graph.write_text(graph_of("/odom"))

    def secured(*options, keystore=True, text=None):
        if text:
            graph.write_text(text)
        output = ["-o", str(tmp_path / "keystore")] if keystore else []
        return rtron("secure", str(plan), "--graph", str(graph), *output, *options)

    secured.folder = tmp_path / "keystore"
    return secured


def test_a_keystore_is_written_and_then_fits(secure):
    written_one = secure()
    assert written_one.code == 0
    assert "4 enclaves, 4 written" in written_one.out
    assert "+ publish /rtron/cmd_vel/nav" in written_one.out
    assert "rosout" not in written_one.out
    assert (secure.folder / "enclaves/rtron_guard/permissions.p7s").is_file()
    again = secure("--diff")
    assert again.code == 0
    assert "4 enclaves, 0 differ" in again.out


def test_a_difference_is_shown_before_it_is_made(secure):
    secure()
    shown = secure("--diff", text=graph_of("/map"))
    assert shown.code == 1
    assert "- publish rt/odom" in shown.out
    assert "+ publish rt/map" in shown.out
    again = json.loads(secure("--diff", "--format", "json").out)
    (nav,) = (each for each in again["enclaves"] if each["enclave"] == "/nav")
    assert (nav["added"], nav["removed"]) == (["publish rt/map"], ["publish rt/odom"])
    assert not again["written"]
    assert secure().code == 0
    assert secure("--diff").code == 0


def test_an_enclave_without_a_node_is_a_difference_until_it_is_revoked(secure):
    secure(text=graph_of(nodes=(Node(name="/old"),)))
    shown = secure("--diff", text=graph_of())
    assert shown.code == 1
    assert "/old: no node of the app has it" in " ".join(shown.out.split())
    assert "Revoked" in secure("--revoke", "/old").out
    assert secure("--diff").code == 0


def test_the_policy_is_printed_or_written_to_a_file(secure):
    printed = secure("--policy-only", keystore=False)
    root = ET.fromstring(printed.out.encode())
    paths = [each.get("path") for each in root.iter("enclave")]
    assert paths == ["/rtron_guard", "/rtron_verify", "/driver", "/nav"]
    secure("--policy-only")
    assert secure.folder.read_text() == printed.out


def test_what_may_break_is_told(secure):
    shown = secure(text=graph_of("/{robot}/map", nodes=(Node(name="/blob", unread=True),)))
    assert "What may break under Enforce" in shown.out
    assert "/nav   publish /{robot}/map" in shown.out
    assert "/blob  the node" in shown.out


def test_a_launch_with_enclaves_is_written_where_the_plan_only_observes(secure, rtron, tmp_path):
    plan, launch = tmp_path / "rtron.yaml", tmp_path / "app.launch.xml"
    plan.write_text(plan.read_text().replace("mode: enforce", "mode: observe"))
    secure()
    launch.write_text('<launch><node pkg="n" exec="n" name="nav"/></launch>')
    words = ("--graph", tmp_path / "graph.json", "--keystore", secure.folder)
    out = tmp_path / "out.launch.xml"
    ran = rtron("instrument", launch, "--plan", plan, *words, "-o", out)
    assert (ran.err, out.is_file()) == ("", True)


def test_without_a_keystore_it_says_what_to_give(secure):
    refused = secure(keystore=False)
    assert refused.code == 2
    assert "add -o KEYSTORE" in refused.err


def test_names_of_strangers_reach_no_terminal(secure):
    shown = secure(text=graph_of("/a\u001b[31mred"))
    assert "\u001b" not in shown.out


@pytest.mark.parametrize(("begun", "found"), [("/rtron_g", ["/rtron_guard"]), ("x", [])])
def test_the_shell_completes_the_enclaves_of_the_keystore(secure, begun, found):
    secure()
    context = SimpleNamespace(params={"output": str(secure.folder)})
    assert _complete_enclave(context, begun) == found
    assert _complete_enclave(SimpleNamespace(params={}), begun) == []
