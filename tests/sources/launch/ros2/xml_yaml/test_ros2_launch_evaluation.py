"""Reading XML and YAML launch files of ROS 2 as launch and launch_ros would run them.

Scopes, the environment, timers, what decides what, and the bounds that hold against strangers.
"""

import os

import pytest

from rtron.errors import InputError
from rtron.sources.launch.ros2 import limits
from rtron.sources.launch.ros2.limits import MAX_LEVELS
from rtron.sources.launch.ros2.reader import read_ros2_launch
from rtron.sources.launch.ros2.substitutions.substitution import MAX_TEXT

TELEOP = '<node pkg="t" exec="t" name="teleop"/>'
NAMED = '<node pkg="t" exec="t" name="$(var config)"/>'
INCLUDE = '<include file="$(dirname)/in.launch.xml"{}><arg name="config" value="c"/></include>'
REMAP = '<set_remap from="v" to="/cmd_vel"/>'


@pytest.fixture
def read(tmp_path):
    """Return a function that reads a launch file of some actions, for some arguments."""

    def tree(text, environ=None, **arguments):
        app = tmp_path / "app.launch.xml"
        app.write_text(f"<launch>{text}</launch>")
        return read_ros2_launch(app, arguments, environ or {}, {"pkg": tmp_path})

    return tree


def led(tree, name="/teleop"):
    """Return where the names of a node lead."""
    [node] = [node for node in tree.nodes() if node.name == name]
    return {remap.source: remap.target for remap in node.remaps}


def choices(tree):
    """Return what a tree depends on, without the namespace that every node's name depends on."""
    return {one.name: one.values for one in tree.inputs if one.name != "ros_namespace"}


def test_a_set_remap_in_a_group_is_added_to_the_list_that_is_there_already(read):
    before = '<set_remap from="w" to="/x"/>'
    assert led(read(f"<group>{REMAP}</group>{TELEOP}")) == {}
    assert led(read(f"{before}<group>{REMAP}</group>{TELEOP}")) == {"/w": "/x", "/v": "/cmd_vel"}
    deep = f"{before}<group><group>{REMAP}</group></group>{TELEOP}"
    assert led(read(deep)) == {"/w": "/x", "/v": "/cmd_vel"}


@pytest.mark.parametrize(
    "emptied", ['<group forwarding="false">{}</group>', "<group><reset/>{}</group>"]
)
def test_a_set_remap_does_not_leave_a_group_that_begins_empty(read, emptied):
    before = '<set_remap from="w" to="/x"/>'
    assert led(read(before + emptied.format(REMAP) + TELEOP)) == {"/w": "/x"}
    assert led(read(before + emptied.format(TELEOP))) == {}


def test_an_unscoped_group_and_an_include_share_their_scope(read, tmp_path):
    assert led(read(f'<group scoped="false">{REMAP}</group>{TELEOP}')) == {"/v": "/cmd_vel"}
    (tmp_path / "in.launch.xml").write_text(f"<launch>{REMAP}</launch>")
    include = '<include file="$(dirname)/in.launch.xml"/>'
    assert led(read(include + TELEOP)) == {"/v": "/cmd_vel"}
    assert led(read(f"<group>{include}</group>{TELEOP}")) == {}


@pytest.mark.parametrize("scoped", ["false", "False", "no", "off"])
def test_every_way_to_say_that_a_group_has_no_scope(read, scoped):
    assert led(read(f'<group scoped="{scoped}">{REMAP}</group>{TELEOP}')) == {"/v": "/cmd_vel"}


def test_the_namespace_is_a_configuration(read):
    pushed = '<push_ros_namespace namespace="a"/>'
    named = '<node pkg="t" exec="t" name="n" namespace="/x$(var ros_namespace)"/>'
    assert [node.name for node in read(pushed + named).nodes()] == ["/x/a/n"]
    assert [node.name for node in read(TELEOP, ros_namespace="b").nodes()] == ["/b/teleop"]
    kept = '<reset><keep name="ros_namespace" value="/c"/></reset>'
    assert [node.name for node in read(pushed + kept + TELEOP).nodes()] == ["/c/teleop"]


def test_timers_run_last_in_the_outermost_scope_and_in_their_order(read, tmp_path):
    late = '<timer period="3.0"><node pkg="t" exec="t" name="late"/></timer>'
    (tmp_path / "in.launch.xml").write_text(f"<launch>{late}</launch>")
    pushed = '<push_ros_namespace namespace="a"/>'
    inside = f'<group>{pushed}<include file="$(dirname)/in.launch.xml"/></group>'
    first = f'<timer period="1.0">{REMAP}</timer>'
    after = f'<timer period="5.0">{REMAP}</timer>'
    assert led(read(inside + first + TELEOP), "/late") == {"/v": "/cmd_vel"}
    assert led(read(inside + after + TELEOP), "/late") == {}
    nested = f'<timer period="1.0"><timer period="1.0">{REMAP}</timer></timer>'
    assert led(read(inside + nested), "/late") == {"/v": "/cmd_vel"}
    assert led(read(inside + first + TELEOP)) == {}


def test_the_environment_that_the_launch_sets(read):
    node = '<node pkg="t" exec="t" name="$(env WHO nobody)"/>'
    set_env = '<set_env name="WHO" value="teleop"/>'
    environ = {"WHO": "joy"}
    assert [n.name for n in read(set_env + node, environ).nodes()] == ["/teleop"]
    assert [n.name for n in read(f"<group>{set_env}</group>{node}", environ).nodes()] == ["/joy"]
    assert [n.name for n in read(f'<unset_env name="WHO"/>{node}', environ).nodes()] == ["/nobody"]
    assert [n.name for n in read(f"{set_env}<reset_env/>{node}", environ).nodes()] == ["/joy"]
    append_env = '<append_env name="WHO" value="x"/>'
    [unknown] = read(append_env + node, environ).nodes()
    assert unknown.anonymous
    assert [n.name for n in read(f"{append_env}<reset_env/>{node}", environ).nodes()] == ["/joy"]


def test_an_environment_that_the_launch_replaces(read):
    """Lyrical: nothing is left of the one before, and the new values are those of the old one."""
    node = '<node pkg="t" exec="t" name="$(env WHO nobody)"/>'
    replaced = '<rep_env><env name="{}" value="$(env WHO)2"/></rep_env>' + node
    environ = {"WHO": "joy"}
    assert [n.name for n in read(replaced.format("WHO"), environ).nodes()] == ["/joy2"]
    assert [n.name for n in read(replaced.format("WHAT"), environ).nodes()] == ["/nobody"]
    in_group = f"<group>{replaced.format('WHAT')}</group>{node}"
    assert [n.name for n in read(in_group, environ).nodes()] == ["/nobody", "/joy"]


def test_what_decides_a_name_a_file_or_what_starts(read, tmp_path):
    (tmp_path / "in.launch.xml").write_text(f"<launch>{TELEOP}</launch>")
    declared = '<arg name="a" default="x"/><arg name="b" default="in"/>'
    named = '<node pkg="t" exec="$(var a)" name="n"><param name="p" value="$(var a)"/></node>'
    assert choices(read(declared + named)) == {}
    included = '<include file="$(dirname)/$(var b).launch.xml"/>'
    assert choices(read(declared + included)) == {"b": (None, "in")}
    assert choices(read(declared + included, b="in")) == {"b": ("in",)}
    let = '<let name="c" value="$(var a)_$(env HERE)"/>'
    pushed = '<push_ros_namespace namespace="$(var c)"/>'
    found = choices(read(declared + let + pushed, {"HERE": "h"}))
    assert found == {"a": (None, "x"), "HERE": ("h",)}
    assert choices(read('<node pkg="t" exec="t" name="$(var d e)"/>')) == {"d": (None,)}


@pytest.mark.parametrize(
    ("action", "fake_study"),
    [
        (TELEOP.replace("/>", ' if="$(var a)"/>'), {}),
        (TELEOP.replace("/>", ' unless="$(var a)"/>'), {"a": (None, "true")}),
        (f'<group unless="$(var a)">{TELEOP}</group>', {"a": (None, "true")}),
        (f'<group if="$(var a)">{REMAP}</group>', {}),
        (INCLUDE.format(' if="$(var a)"'), {}),
        (INCLUDE.format(' if="$(var a)"') + NAMED, {"a": (None, "true")}),
        (INCLUDE.format(' unless="$(var a)"'), {"a": (None, "true")}),
        ('<group if="$(var a)" scoped="false"><reset_env/></group>', {"a": (None, "true")}),
        (f'<group if="$(var a)" scoped="false">{REMAP}</group>', {"a": (None, "true")}),
        ('<let name="b" value="c" if="$(var a)"/>', {"a": (None, "true")}),
        ('<log message="" unless="$(var a)"/>', {}),
        (TELEOP.replace("/>", ' args="$(var a)"/>'), {}),
        (TELEOP.replace("/>", ' args="$(var a) --ros-args -r b:=c"/>'), {"a": (None, "true")}),
    ],
)
def test_a_condition_decides_where_another_value_would_start_what_was_not_read(
    read, tmp_path, action, fake_study
):
    (tmp_path / "in.launch.xml").write_text("<launch/>")
    assert choices(read(f'<arg name="a" default="true"/>{action}')) == fake_study


@pytest.mark.parametrize("cmd", ["ros2 run t t", "bash -c 'ros2 launch x y'", "gzserver"])
def test_a_process_that_is_no_node_is_noted(read, cmd):
    [note] = read(f'<executable cmd="{cmd}"/>').unresolved
    assert note.what == f"executable {cmd}"
    assert "no remaps" in note.why
    assert read(f'<executable cmd="{cmd}" if="false"/>').unresolved == ()


def test_an_action_that_is_not_known_is_noted(read):
    [note] = read("<launch_it_all/><log message=''/><set_parameter name='a' value='b'/>").unresolved
    assert note.what == "launch_it_all"


def test_rules_of_a_node_whose_name_is_not_known_are_kept_for_the_names_it_may_have(read):
    [node] = read('<node pkg="t" exec="t"><remap from="base:out" to="/cmd_vel"/></node>').nodes()
    assert [remap.written_source for remap in node.remaps] == ["base:out"]


def test_texts_that_double_each_other_end_at_the_bound(read):
    doubling = '<let name="a" value="$(var a)$(var a)"/>' * 60
    with pytest.raises(InputError, match=f"longer than {MAX_TEXT}"):
        read(f'<let name="a" value="ha"/>{doubling}')


def test_levels_are_bounded(read):
    fits, over = MAX_LEVELS - 1, MAX_LEVELS
    assert len(read("<group>" * fits + TELEOP + "</group>" * fits).nodes()) == 1
    with pytest.raises(InputError, match="levels"):
        read("<group>" * over + TELEOP + "</group>" * over)


def test_actions_are_bounded_over_all_files(read, tmp_path, monkeypatch):
    monkeypatch.setattr(limits, "MAX_ACTIONS", 100)
    (tmp_path / "in.launch.xml").write_text(f"<launch>{TELEOP * 9}</launch>")
    include = '<include file="$(dirname)/in.launch.xml"/>'
    assert len(read(include * 10).nodes()) == 90
    with pytest.raises(InputError, match="actions"):
        read(include * 10 + TELEOP)


@pytest.mark.parametrize(
    ("name", "most", "action", "what"),
    [
        ("MAX_NODES", 5, TELEOP, "nodes"),
        ("MAX_REMAPS", 5, REMAP, "shared remaps"),
        ("MAX_NAMES", 5, '<let name="n{}" value=""/>', "configurations"),
        ("MAX_ACTIONS", 10, TELEOP[:-2] + '><remap from="a" to="b"/></node>', "actions"),
    ],
)
def test_counts_are_bounded(read, monkeypatch, name, most, action, what):
    monkeypatch.setattr(limits, name, most)
    five = "".join(action.format(number) for number in range(5))
    read(five)
    with pytest.raises(InputError, match=f"more than {most} {what}"):
        read(five + action.format(5) + "<log message=''/>")


def test_the_size_of_all_files_is_bounded(read, tmp_path, monkeypatch):
    included = tmp_path / "in.launch.xml"
    included.write_text(f"<launch>{' ' * 1000}</launch>")
    include = '<include file="$(dirname)/in.launch.xml"/>'
    of_all = 2 * included.stat().st_size + len(f"<launch>{include * 2}</launch>")
    monkeypatch.setattr(limits, "MAX_BYTES", of_all)
    assert read(include * 2).unresolved == ()
    with pytest.raises(InputError, match="bytes in all files"):
        read(include * 2 + " ")


def test_files_that_include_each_other_in_a_circle_end(read, tmp_path):
    for name, other in (("one", "two"), ("two", "one")):
        include = f'<include file="$(dirname)/{other}.launch.xml"/>'
        (tmp_path / f"{name}.launch.xml").write_text(f"<launch>{include * 30}</launch>")
    with pytest.raises(InputError, match="more than"):
        read('<include file="$(dirname)/one.launch.xml"/>')


@pytest.mark.parametrize("kind", ["fifo", "folder"])
def test_what_is_no_file_is_not_opened(read, tmp_path, kind):
    for suffix in ("xml", "yaml"):
        path = tmp_path / f"in.launch.{suffix}"
        os.mkfifo(path) if kind == "fifo" else path.mkdir()
        [note] = read(f'<include file="$(dirname)/{path.name}"/>').unresolved
        assert "no file" in note.why


@pytest.mark.parametrize("suffix", ["xml", "yaml"])
@pytest.mark.parametrize("place", ["$(dirname)", "$(find-pkg-share {})"])
def test_a_name_that_no_file_can_have_is_not_opened(tmp_path, place, suffix):
    long = "n" * 5000
    app = tmp_path / "app.launch.xml"
    file = f"{place.format(long)}/{long}.launch.{suffix}"
    app.write_text(f'<launch><include file="{file}"/></launch>')
    [note] = read_ros2_launch(app, {}, {"AMENT_PREFIX_PATH": str(tmp_path)}, {}).unresolved
    assert "File name too long" in note.why or "is not here" in note.why


@pytest.mark.parametrize(
    "text", ["launch:\n- node: {name: a, name: b}", "launch:\n- node: {<<: {name: a}, name: b}"]
)
def test_yaml_in_which_two_readers_can_see_two_things_is_refused(tmp_path, text):
    app = tmp_path / "app.launch.yaml"
    app.write_text(text)
    with pytest.raises(InputError, match="twice"):
        read_ros2_launch(app, {}, {}, {})
