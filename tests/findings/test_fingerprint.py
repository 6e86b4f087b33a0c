"""A finding's fingerprint finds it again in the next scan."""

import re
from dataclasses import replace

from finding_graphs import BASE, TWIST, TWO_DRIVERS, small_graph, the_finding

from rtron.vocabulary import Evidence

TEXT = TWO_DRIVERS + BASE


def fingerprint(text: str = TEXT, line: int = 1, rule: str = "several_publishers") -> str:
    graph = small_graph(text)
    ends = tuple(
        replace(end, evidence=(Evidence(file="a.py", line=line),)) for end in graph.endpoints
    )
    return the_finding(rule, replace(graph, endpoints=ends)).fingerprint


def test_it_is_16_hex_digits_that_never_change():
    assert re.fullmatch("[0-9a-f]{16}", fingerprint())
    assert fingerprint() == "0edb459d16e2f34e"


def test_it_stays_when_lines_move_and_unrelated_nodes_come():
    assert fingerprint(line=99) == fingerprint()
    assert fingerprint(TEXT + "/camera camera own\n pub /image sensor_msgs/msg/Image") == (
        fingerprint()
    )


def test_it_stays_when_the_nodes_stand_in_another_order():
    blocks = TWO_DRIVERS.strip().replace("\n/", "\n\n/").split("\n\n")
    assert fingerprint("\n".join([BASE, *reversed(blocks)])) == fingerprint()


def test_it_changes_with_the_nodes_the_topic_and_the_rule():
    prints = {
        fingerprint(),
        fingerprint(TEXT.replace("/teleop ", "/joystick ")),
        fingerprint(TEXT + f"/other other own\n pub /cmd_vel {TWIST}"),
        fingerprint(TEXT.replace("/cmd_vel", "/robot/cmd_vel")),
        fingerprint(BASE, rule="open_command"),
    }
    assert len(prints) == 5


def test_names_do_not_run_into_each_other():
    finding = the_finding("several_publishers", small_graph(TEXT))
    one = replace(finding, nodes=("/a", "/b"), topics=())
    assert one.fingerprint != replace(finding, nodes=("/a",), topics=("/b",)).fingerprint
    assert one.fingerprint == replace(finding, nodes=("/b", "/a"), topics=()).fingerprint
