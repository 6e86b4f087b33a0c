"""ROS 1's syntax in a launch file of ROS 2: each word is noted with its place."""

import pytest

ROS1 = """<launch>
  <node pkg="p" type="driver" name="d" ns="arm" required="true">
    <rosparam file="a.yaml"/>
    <remap from="a" to="b"/>
  </node>
</launch>"""


def notes(app):
    return [(note.what, note.why.partition(" is syntax")[0], note.evidence[0].line)
            for note in app.unresolved]  # fmt: skip


def test_a_node_is_read_as_it_is_meant(read):
    app = read(ROS1, "xml")
    (start,) = app.starts
    assert (start.package, start.program, start.full_name) == ("p", "driver", "/arm/d")
    assert start.remaps == (("a", "b"),)
    assert notes(app) == [
        *(("node d", f"its {name}", 2) for name in ("type", "ns", "required")),
        ("rosparam a.yaml", "it, in <node>,", 3),
    ]
    assert app.unresolved[0].why.endswith("is syntax of ROS 1, which the launch of ROS 2 refuses")


@pytest.mark.parametrize(
    ("text", "note"),
    [
        ('<group ns="a"/>', ("group", "its ns")),
        ('<machine name="m"/>', ("machine m", "it, in <launch>,")),
        ('<test pkg="p"/>', ("test", "it, in <launch>,")),
        ('<remap from="a" to="b"/>', ("remap a", "it, in <launch>,")),
        ('<group><param name="a"/></group>', ("param a", "it, in <group>,")),
        ('<node pkg="p" exec="$(arg x)" name="a"/>', ("node a", "$(arg …) is not evaluated")),
    ],
)
def test_each_word_of_ros1_is_noted(read, text, note):
    found = notes(read(f"<launch>\n{text}</launch>", "xml"))
    assert [(what, why.partition(":")[0]) for what, why, _ in found] == [note]
    assert [line for *_, line in found] == [2]


def test_ros2_has_no_notes(read):
    text = """<launch><arg name="a" default="b"/><let name="c" value="d"/>
    <group><push_ros_namespace namespace="n"/><set_remap from="a" to="b"/>
    <node pkg="p" exec="e" name="f" namespace="g"><param name="h" value="1"/><remap from="a"
    to="$(var a)"/></node></group></launch>"""
    assert not read(text, "xml").unresolved
