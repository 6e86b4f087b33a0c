"""What a launch line hides: names on the command line, prefixes, programs that are not here."""

import pytest
from test_static_app import ends

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros1.app import scan_app
from rtron.vocabulary import WiringFactKind

MANIFEST = '<?xml version="1.0.0"?>\n<package><name>{}</name></package>'
TALK = """#!/usr/bin/env python
import rospy
from std_msgs.msg import Bool
rospy.Publisher("chatter", Bool)
rospy.Publisher(rospy.get_param("~topic", "none"), Bool)
"""


def scan(tmp_path, body, package="p", script="talk.py"):
    folder = tmp_path / package
    folder.mkdir()
    (folder / "package.xml").write_text(MANIFEST.format(package))
    (folder / script).write_text(TALK)
    (folder / script).chmod(0o755)
    launch = folder / "app.launch"
    launch.write_text(f'<?xml version="1.0.0"?>\n<launch>{body}</launch>')
    options = ScanOptions(workers=1, cache=None)
    return scan_app([tmp_path], [(launch, {})], {}, options).graph


def node(attributes, inside=""):
    return f'<node pkg="p" type="talk.py" name="n" {attributes}>{inside}</node>'


@pytest.mark.parametrize(
    ("args", "name", "topics"),
    [
        ("", "/n", {"/chatter", "/none"}),
        ("chatter:=/a", "/n", {"/a", "/none"}),
        ("__ns:=/foo __name:=m chatter:=b", "/foo/n", {"/foo/b", "/foo/none"}),
        ("__ns:=foo _topic:=~own", "/foo/n", {"/foo/chatter", "/foo/n/own"}),
    ],
)
def test_names_on_the_command_line_count(tmp_path, args, name, topics):
    graph = scan(tmp_path, node(f'args="{args}"'))
    assert [node.name for node in graph.nodes] == [name]
    assert {f"> {topic}" for topic in topics} <= set(ends(graph, name))
    assert graph.unresolved == ()


@pytest.mark.parametrize("prefix", ["xterm -e", "/usr/bin/gdb --args", "nice -n 5", ""])
def test_a_usual_prefix_is_not_noted(tmp_path, prefix):
    assert scan(tmp_path, node(f'launch-prefix="{prefix}"')).unresolved == ()


@pytest.mark.parametrize(
    ("attributes", "inside"),
    [
        ('launch-prefix="rosrun topic_tools relay /a /b"', ""),
        ("", '<env name="LD_PRELOAD" value="x.so"/>'),
        ("", '<env name="PYTHONPATH" value="/x"/>'),
    ],
)
def test_what_may_run_something_else_is_noted(tmp_path, attributes, inside):
    (note,) = scan(tmp_path, node(attributes, inside)).unresolved
    assert note.why.endswith("not looked at")
    assert (note.evidence[0].file[-10:], note.evidence[0].line) == ("app.launch", 2)


def test_a_model_of_a_program_that_is_here_without_source_is_noted(tmp_path):
    body = '<node pkg="topic_tools" type="relay" name="n" args="/a /b"/>'
    graph = scan(tmp_path, body, package="topic_tools")
    why = "its program's source is not here; the model of that name counts"
    assert [note.why for note in graph.unresolved] == [why]


def test_what_stands_in_for_the_nodelet_loader_is_read(tmp_path):
    body = '<node pkg="nodelet" type="nodelet" name="n" args="manager"/>'
    graph = scan(tmp_path, body, package="nodelet", script="nodelet")
    assert {"> /chatter", "> /none"} <= set(ends(graph, "/n"))


@pytest.mark.parametrize(
    ("args", "once"),
    [
        ("pub /go std_msgs/Bool true", ["/stop"]),
        ("pub -1 /go std_msgs/Bool true", ["/stop"]),
        ("pub -r 10 /go std_msgs/Bool true", []),
        ("pub -r10 /go std_msgs/Bool true", []),
        ("pub -sr10 /go std_msgs/Bool true", []),
        ("pub /go std_msgs/Bool true --rate=10", []),
    ],
)
def test_a_topic_pub_without_a_rate_sends_once(tmp_path, args, once):
    graph = scan(tmp_path, f'<node pkg="rostopic" type="rostopic" name="stop" args="{args}"/>')
    kind = WiringFactKind.SENT_ONCE
    assert [fact.subject for fact in graph.wiring if fact.kind is kind] == once
