"""What the rule says of a frame that no transform has, and when it is silent."""

from dataclasses import replace

import pytest
from finding_graphs import FIRMWARE, found, small_graph, the_finding
from finding_pairs import SCAN, with_fact

from rtron.vocabulary import Certainty, FindingLevel, Severity

WIRING = with_fact("stray_frame", "pico_1", "pico", "/laser").wiring
TRANSFORMS = "    sub /tf tf2_msgs/msg/TFMessage\n"
RVIZ = "/rviz rviz2 third_party\n    sub /scan sensor_msgs/msg/LaserScan\n"
CAMERA = "/laser driver own\n    pub /image sensor_msgs/msg/Image\n"
VIEW = "/view view own\n    sub /image sensor_msgs/msg/Image\n"
STATUS = (CAMERA + VIEW).replace("sensor_msgs/msg/Image", "std_msgs/msg/Bool")
STRAY = small_graph(SCAN + TRANSFORMS, wiring=WIRING)


def test_it_names_the_frame_and_a_near_one():
    finding = the_finding("stray_frame", STRAY)
    assert finding.summary == (
        "/laser sends messages in the frame pico_1, which is in no transform"
    )
    assert finding.remedy == "did you mean pico? Give the messages and the transform one name"
    assert (finding.certainty, finding.severity) == (Certainty.LIKELY, Severity.MEDIUM)
    assert finding.level is FindingLevel.REGULAR


def test_a_node_that_was_not_read_may_send_the_transform():
    unread = small_graph(SCAN + FIRMWARE, unread=("/firmware",))
    assert not found("stray_frame", replace(unread, wiring=STRAY.wiring))


@pytest.mark.parametrize(
    ("more", "level"),
    [
        ("", "pedantic"),
        ("/other o own\n" + TRANSFORMS, "pedantic"),
        (RVIZ + TRANSFORMS, "pedantic"),
        (TRANSFORMS, "regular"),
        (TRANSFORMS.replace("/tf ", "/tf_static "), "regular"),
        (TRANSFORMS + CAMERA, "regular"),
        (TRANSFORMS + CAMERA + VIEW, "pedantic"),
        (TRANSFORMS + STATUS, "regular"),
    ],
)
def test_who_reads_the_messages_must_transform_them(more, level):
    assert the_finding("stray_frame", small_graph(SCAN + more, wiring=WIRING)).level == level


@pytest.mark.parametrize(
    ("process", "more", "level"),
    [
        ({"/slam": "", "/listener": "/slam"}, "", "regular"),
        ({"/slam": "/launched", "/listener": "/launched"}, "", "regular"),
        ({"/slam": "/other", "/listener": "/launched"}, "", "pedantic"),
        ({"/slam": "/box", "/listener": "/box"}, "/box container own\n", "pedantic"),
    ],
)
def test_a_listener_may_be_a_node_of_its_own_in_the_process(process, more, level):
    text = f"{SCAN}/listener slam own\n{TRANSFORMS}{more}"
    graph = small_graph(text, wiring=WIRING)
    nodes = (replace(node, process=process.get(node.name, "")) for node in graph.nodes)
    assert the_finding("stray_frame", replace(graph, nodes=tuple(nodes))).level == level


def missing(near, kind="missing_frame"):
    return small_graph(SCAN, wiring=with_fact(kind, "pico_1", near, "/slam").wiring)


def test_a_frame_that_is_looked_up_is_likely_missing_where_a_near_one_is_there():
    finding = the_finding("stray_frame", missing("pico"))
    assert finding.summary == "/slam looks up the frame pico_1, which nobody broadcasts"
    assert finding.cause == "the transforms of this launch have pico"
    assert finding.remedy == "did you mean pico? Give the look-up and the transform one name"
    assert finding.level is FindingLevel.REGULAR


def test_without_a_near_one_another_launch_may_send_it():
    finding = the_finding("stray_frame", missing("", "possible_missing_frame"))
    told = (finding.cause, finding.remedy)
    assert told == ("no node of this launch does", "start what broadcasts pico_1")
    assert finding.level is FindingLevel.PEDANTIC


def test_a_base_of_another_name_is_named_though_another_launch_may_send_it():
    finding = the_finding("stray_frame", missing("base_link", "possible_missing_frame"))
    assert finding.cause == "the transforms of this launch have base_link"
    assert finding.level is FindingLevel.PEDANTIC


def test_what_was_not_read_may_send_what_is_looked_up():
    unread = small_graph(SCAN + FIRMWARE, unread=("/firmware",))
    finding = the_finding("stray_frame", replace(unread, wiring=missing("pico").wiring))
    assert finding.cause.endswith("have pico, unless /firmware (not read) does")
    assert finding.level is FindingLevel.PEDANTIC


def test_a_slash_is_too_much_whoever_sends_the_transform():
    fact = with_fact("missing_frame", "/pico", "pico", "/slam").wiring
    unread = small_graph(SCAN + FIRMWARE, unread=("/firmware",))
    finding = the_finding("stray_frame", replace(unread, wiring=fact))
    expected = "tf2 takes no frame with a slash before it; the transforms of this launch have pico"
    assert (finding.cause, finding.level) == (expected, FindingLevel.REGULAR)


def test_a_frame_of_messages_is_not_told_twice():
    both = (*WIRING, *missing("pico").wiring)
    assert "sends messages" in the_finding("stray_frame", replace(STRAY, wiring=both)).summary
