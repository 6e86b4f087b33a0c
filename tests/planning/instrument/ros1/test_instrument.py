"""Guarding a launch, with no ROS: which remaps, what stays of the text, what is said."""

from codecs import BOM_UTF8

import pytest
from plans import grcn, plan_of

from rtron.errors import InputError, PlanError
from rtron.planning.instrument import instrument_ros1
from rtron.planning.instrument.common.guarded_launch import GuardFiles
from rtron.sources.launch.ros1.reader import read_launch
from rtron.vocabulary import (
    MSRCN,
    RSRCN,
    Flow,
    GuardedTopic,
    LaunchFile,
    LaunchNode,
    LaunchTree,
    Mode,
    PolicyName,
)

NODE = '<node pkg="p" type="t" name="{}"/>'
T = "/cmd_vel"


@pytest.fixture
def guard(tmp_path):
    """Return a function that writes a launch file and others, and guards it by a plan."""

    def guarded(body, plan, **files):
        for name, text in files.items():
            (tmp_path / f"{name}.launch").write_text(f"<launch>{text}</launch>")
        app = tmp_path / "app.launch"
        app.write_text(f"<launch>{body}</launch>")
        tree = read_launch(app, {}, {}, {})
        out = tmp_path / "out" / "guarded.launch"
        return instrument_ros1(tree, plan, out, GuardFiles("the plan", command=("guard", "it's")))

    return guarded


def remaps(instrumented):
    return [(remap.node, remap.written, remap.target) for remap in instrumented.remaps]


def said(instrumented):
    return [(found.what, found.accepted) for found in instrumented.unenforceable]


def test_the_five_topics_of_an_action_move_together(guard):
    nodes = "".join(map(NODE.format, "abs"))
    action = grcn("/act/goal", ["/a", "/s"], ["/s"], type="p/GoActionGoal")
    guarded = guard(nodes, plan_of(action))
    moved = {}
    for node, written, target in remaps(guarded):
        moved.setdefault(node, {})[written] = target
    private = "/rtron/act"
    assert moved == {
        "/a": {
            "/act/goal": f"{private}/goal/flow1",
            "/act/cancel": f"{private}/cancel/flow1",
            "/act/status": f"{private}/status/out",
            "/act/feedback": f"{private}/feedback/out",
            "/act/result": f"{private}/result/out",
        },
        "/s": {
            "/act/goal": f"{private}/goal/flow2",
            "/act/cancel": f"{private}/cancel/flow2",
            "/act/status": f"{private}/status/server",
            "/act/feedback": f"{private}/feedback/server",
            "/act/result": f"{private}/result/server",
        },
    }


def test_a_server_that_gives_itself_no_goals_hears_the_private_outputs(guard):
    action = grcn("/act/goal", ["/a"], ["/s"], type="p/GoActionGoal")
    guarded = guard(NODE.format("s"), plan_of(action))
    targets = {written: target for _, written, target in remaps(guarded)}
    assert targets["/act/cancel"] == "/rtron/act/cancel/out"
    assert targets["/act/result"] == "/rtron/act/result/server"


def test_each_publisher_has_its_flow_and_each_successor_the_output(guard):
    nodes = "".join(map(NODE.format, "abc"))
    guarded = guard(nodes, plan_of(grcn(T, ["/a", "/b"], ["/c"])))
    assert remaps(guarded) == [
        ("/a", T, "/rtron/cmd_vel/flow1"),
        ("/b", T, "/rtron/cmd_vel/flow2"),
        ("/c", T, "/rtron/cmd_vel/out"),
    ]
    assert guarded.unenforceable == guarded.notes == ()


def test_an_observed_topic_is_left_alone(guard):
    plan = plan_of(grcn(T, ["/a"], ["/absent"], mode=Mode.OBSERVE))
    guarded = guard(NODE.format("a"), plan)
    assert remaps(guarded) == said(guarded) == []


def test_every_kind_of_coordination_node_is_closed(guard):
    def guarded_topic(topic):
        flow = Flow(name="f", publisher="/a")
        return (GuardedTopic(topic=topic, type="t/T", flows=(flow,), successors=("/b",)),)

    block = {"mode": Mode.ENFORCE, "policy": PolicyName.BLOCK}
    rsrcn = RSRCN(id="r", vflows=guarded_topic("/v"), **block)
    msrcn = MSRCN(id="m", aflows=guarded_topic("/goal"), **block)
    guarded = guard(NODE.format("a"), plan_of(rsrcn=rsrcn, msrcn=msrcn))
    assert {target for _, _, target in remaps(guarded)} == {"/rtron/v/f", "/rtron/goal/f"}


def test_a_node_on_both_sides_has_one_private_name_and_it_is_said(guard):
    guarded = guard(NODE.format("a"), plan_of(grcn(T, ["/a"], ["/a"])))
    assert remaps(guarded) == [("/a", T, "/rtron/cmd_vel/flow1")]
    assert said(guarded) == []
    assert "delivers to itself" in guarded.notes[0]


def test_a_remap_that_leads_to_the_topic_leads_to_the_private_one(guard):
    node = '<node pkg="p" type="t" name="a" ns="g"><remap from="~out" to="/cmd_vel"/></node>'
    guarded = guard(f'<remap from="speed" to="{T}"/>{node}', plan_of(grcn(T, ["/g/a"], [])))
    private = "/rtron/cmd_vel/flow1"
    assert remaps(guarded) == [
        ("/g/a", "speed", private),
        ("/g/a", "~out", private),
        ("/g/a", T, private),
    ]


@pytest.mark.parametrize("spelling", ["cmd_vel", "/cmd_vel"])
def test_a_topic_that_is_remapped_away_stays_away(guard, spelling):
    node = f'<node pkg="p" type="t" name="a"><remap from="{spelling}" to="other"/></node>'
    guarded = guard(node, plan_of(grcn(T, ["/a"], []), accept_unenforceable=("/a",)))
    assert remaps(guarded) == []
    assert said(guarded) == [("/a", True)]


def test_a_topic_away_and_another_name_in_its_place(guard):
    away = '<remap from="cmd_vel" to="old"/><remap from="new" to="cmd_vel"/>'
    node = f'<node pkg="p" type="t" name="a">{away}</node>'
    guarded = guard(node, plan_of(grcn(T, ["/a"], [])))
    assert remaps(guarded) == [("/a", "new", "/rtron/cmd_vel/flow1")]
    assert said(guarded) == []


def test_a_topic_remapped_to_itself_is_guarded_under_that_spelling(guard):
    node = '<node pkg="p" type="t" name="a"><remap from="cmd_vel" to="cmd_vel"/></node>'
    guarded = guard(node, plan_of(grcn(T, ["/a"], [])))
    assert remaps(guarded) == [("/a", "cmd_vel", "/rtron/cmd_vel/flow1")]


def test_of_two_spellings_of_a_name_both_are_placed_in_their_order(guard):
    both = '<remap from="~x" to="cmd_vel"/><remap from="/a/x" to="~y"/>'
    guarded = guard(f'<node pkg="p" type="t" name="a">{both}</node>', plan_of(grcn(T, ["/a"], [])))
    assert remaps(guarded)[:2] == [("/a", "~x", "/rtron/cmd_vel/flow1"), ("/a", "/a/x", "~y")]


def test_an_exact_publisher_comes_before_a_pattern(guard):
    guarded = guard(NODE.format("a_1"), plan_of(grcn(T, ["/a_*", "/a_1"], [])))
    assert remaps(guarded) == [("/a_1", T, "/rtron/cmd_vel/flow2")]


def test_anonymous_nodes_are_meant_by_a_pattern(guard):
    guarded = guard(NODE.format("$(anon a)"), plan_of(grcn(T, ["/a_*"], [])))
    assert remaps(guarded) == [("/a_*", T, "/rtron/cmd_vel/flow1")]


def test_a_remap_of_an_anonymous_name_cannot_be_replaced(guard):
    remap = '<remap from="/$(anon a)/x" to="cmd_vel"/>'
    node = f'<node pkg="p" type="t" name="$(anon a)">{remap}</node>'
    guarded = guard(node, plan_of(grcn(T, ["/a_*"], [])))
    assert said(guarded) == [("/a_*", False)]
    assert "*" not in guarded.files[guarded.launch]


def test_an_absent_publisher_is_a_note(guard):
    guarded = guard("", plan_of(grcn(T, ["/a"], [])))
    assert said(guarded) == []
    assert "will count as unapproved" in guarded.notes[0]


@pytest.mark.parametrize("launch", ["", '<include file="$(find none)/x.launch"/>'])
def test_a_client_of_a_bridge_is_absent_from_every_launch(guard, launch):
    guarded = guard(launch, plan_of(grcn(T, ["/bridge/tablet"], [])))
    assert said(guarded) == []
    assert not any("/bridge/tablet" in note for note in guarded.notes)


def test_an_absent_publisher_that_may_be_in_what_was_not_read_is_unenforceable(guard):
    guarded = guard('<include file="$(find none)/x.launch"/>', plan_of(grcn(T, ["/a"], [])))
    assert said(guarded) == [("/a", False)]
    assert "$(find none)/x.launch" in guarded.unenforceable[0].why
    (note,) = guarded.notes
    assert note.startswith(f"the plan names no successor of {T}: readers keep the public name")


def test_an_absent_successor_is_unenforceable_unless_accepted(guard):
    plan = plan_of(grcn(T, [], ["/a", "/b"]), accept_unenforceable=("/b",))
    assert said(guard("", plan)) == [("/a", False), ("/b", True)]


MANAGER = '<node pkg="nodelet" type="nodelet" name="m" ns="g" args="manager"/>'


def loader(name, manager="m"):
    args = f'args="load p/C {manager}"'
    return f'<node pkg="nodelet" type="nodelet" name="{name}" ns="g" {args}/>'


def test_a_manager_and_its_loaders_are_remapped(guard):
    others = loader("x", manager="/other") + loader("y", manager="/g/m")
    guarded = guard(MANAGER + loader("l") + others, plan_of(grcn(T, ["/g/m"], [])))
    assert {node for node, _, _ in remaps(guarded)} == {"/g/m", "/g/l", "/g/y"}


def test_a_loader_alone_is_reached_without_its_manager(guard):
    guarded = guard(loader("l"), plan_of(grcn(T, [], ["/g/m"])))
    assert remaps(guarded) == [("/g/l", T, "/rtron/cmd_vel/out")]
    assert said(guarded) == []


def test_nodelets_of_one_manager_on_both_sides_are_unenforceable(guard):
    nodes = MANAGER + loader("a") + loader("b")
    guarded = guard(nodes, plan_of(grcn(T, ["/g/m"], ["/g/m"])))
    assert said(guarded) == [("/g/m", False)]
    assert "/g/a, /g/b" in guarded.unenforceable[0].why


def test_one_nodelet_on_both_sides_is_like_a_node(guard):
    guarded = guard(MANAGER + loader("a"), plan_of(grcn(T, ["/g/m"], ["/g/m"])))
    assert said(guarded) == []
    assert [note.split()[0] for note in guarded.notes] == ["/g/m"]


def test_nodelets_that_the_plan_names_are_on_a_side_each(guard):
    nodes = MANAGER + loader("a") + loader("b")
    guarded = guard(nodes, plan_of(grcn(T, ["/g/a"], ["/g/b"])))
    assert remaps(guarded) == [
        ("/g/a", T, "/rtron/cmd_vel/flow1"),
        ("/g/b", T, "/rtron/cmd_vel/out"),
    ]
    assert said(guarded) == []
    assert all("/g/m's" in note for note in guarded.notes)


@pytest.mark.parametrize("args", ["load p/C 'm", "load p/C", "unload m", ""])
def test_arguments_that_load_nothing_make_no_loader(guard, args):
    node = f'<node pkg="nodelet" type="nodelet" name="x" ns="g" args="{args}"/>'
    guarded = guard(MANAGER + node, plan_of(grcn(T, ["/g/m"], [])))
    assert {node for node, _, _ in remaps(guarded)} == {"/g/m"}


def test_a_standalone_nodelet_is_a_node(guard):
    node = '<node pkg="nodelet" type="nodelet" name="s" args="standalone p/C"/>'
    assert remaps(guard(node, plan_of(grcn(T, ["/s"], [])))) == [("/s", T, "/rtron/cmd_vel/flow1")]


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ('\n  <node name="a" pkg="p" type="t" />', ">\n    {}\n  </node>"),
        ('<node name="a" pkg="p" type="t"/>', ">\n  {}\n</node>"),
        ('\n\t<node name="a" pkg="p"\n\t type="t"></node>', ">\n\t\t{}\n\t</node>"),
        ('\n  <node name="a" pkg="p" type="t"> <!-- x -->\n  </node>', "x -->\n    {}\n  </node>"),
        ('\r\n  <node name="a" pkg="p" type="t"/>', ">\r\n    {}\r\n  </node>"),
        ('<node name="a" pkg="p" type="t" args="a > b"/>', '"a > b">\n  {}\n</node>'),
        ("<node name='a' pkg='p' type='t' args='\"/>'/>", "'\"/>'>\n  {}\n</node>"),
    ],
)
def test_a_remap_stands_as_the_file_is_written(guard, tmp_path, before, after):
    (tmp_path / "app.launch").write_bytes(f"<launch>{before}</launch>".encode())
    tree = read_launch(tmp_path / "app.launch", {}, {}, {})
    plan = plan_of(grcn(T, ["/a"], []))
    guarded = instrument_ros1(tree, plan, tmp_path / "out.launch", GuardFiles(""))
    remap = '<remap from="/cmd_vel" to="/rtron/cmd_vel/flow1"/>'
    assert after.format(remap) in guarded.files[guarded.launch]


def test_a_byte_order_mark_is_no_harm(tmp_path):
    (tmp_path / "app.launch").write_bytes(BOM_UTF8 + b"<launch><!-- \xc3\xa9 --></launch>")
    guarded = out_of_tree(tmp_path)
    (tmp_path / "out.launch").write_text(guarded.files[guarded.launch])
    assert [n.name for n in read_launch(guarded.launch, {}, {}, {}).nodes()] == ["/rtron_guard"]


def out_of_tree(tmp_path):
    tree = read_launch(tmp_path / "app.launch", {}, {}, {})
    return instrument_ros1(tree, plan_of(), tmp_path / "out.launch", GuardFiles(""))


@pytest.mark.parametrize("text", ["<launch/>", "<launch></launch>", "<x><launch a='/'  /></x>"])
def test_the_guard_joins_an_empty_launch(tmp_path, text):
    (tmp_path / "app.launch").write_text(text)
    guarded = out_of_tree(tmp_path)
    (tmp_path / "out.launch").write_text(guarded.files[guarded.launch])
    assert [n.name for n in read_launch(guarded.launch, {}, {}, {}).nodes()] == ["/rtron_guard"]


def test_a_large_launch_is_guarded_in_time(guard):
    nodes = "".join(NODE.format(f"n{n}") for n in range(5000))
    assert len(guard(nodes, plan_of(grcn(T, ["/n*"], []))).remaps) == 5000


def test_only_includes_that_change_are_copied(guard):
    plan = plan_of(grcn(T, ["/deep/n"], []))
    guarded = guard(
        '<include file="$(dirname)/mid.launch"/><include file="$(dirname)/leaf.launch"/>',
        plan,
        mid='<include file="$(dirname)/leaf.launch" ns="deep"/>' + NODE.format("m"),
        leaf=NODE.format("n"),
    )
    assert {path.name for path in guarded.files} == {
        "guarded.launch",
        "01_mid.launch",
        "02_leaf.launch",
        "guard",
        "rtron.yaml",
    }
    assert "leaf.launch" in guarded.files[guarded.launch]


def test_the_guard_runs_the_command_with_the_plan_beside_it(guard):
    guarded = guard("", plan_of())
    assert guarded.files[guarded.folder / "rtron.yaml"] == "the plan"
    script = guarded.files[guarded.folder / "guard"]
    assert script.splitlines()[-1] == """exec guard 'it'"'"'s' --plan "${0%/*}/rtron.yaml\""""


@pytest.mark.parametrize("topic", ["cmd_vel", "/a b", "/$(env X)", "/a//b", '/"', "/a/", ""])
def test_a_topic_that_cannot_be_is_an_error_of_the_plan(guard, topic):
    with pytest.raises(PlanError):
        guard("", plan_of(grcn(topic, ["/a"], [])))


def out_of(tmp_path, out, body="", name="app.launch"):
    (tmp_path / name).write_text(f"<launch>{body}</launch>")
    tree = read_launch(tmp_path / name, {}, {}, {})
    return instrument_ros1(tree, plan_of(), tmp_path / out, GuardFiles(""))


@pytest.mark.parametrize("out", ["app.launch", "x/../app.launch", "link"])
def test_the_input_is_never_overwritten(tmp_path, out):
    (tmp_path / "x").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "app.launch")
    with pytest.raises(InputError, match="would be overwritten"):
        out_of(tmp_path, out)


def test_an_included_file_is_not_overwritten_either(tmp_path):
    (tmp_path / "guarded.d").mkdir()
    (tmp_path / "guarded.d" / "sub.launch").write_text("<launch/>")
    include = '<include file="$(dirname)/guarded.d/sub.launch"/>'
    with pytest.raises(InputError, match="would be overwritten"):
        out_of(tmp_path, "guarded.launch", include)
    with pytest.raises(InputError, match="would be overwritten"):
        out_of(tmp_path, "guarded.d/sub.launch", include)


@pytest.mark.parametrize("out", ["a.d", 'a".launch', "a$.launch", "a'b/c.launch", "a\n.launch"])
def test_a_name_that_roslaunch_could_not_start_is_refused(tmp_path, out):
    with pytest.raises(InputError, match="cannot be the guarded launch file"):
        out_of(tmp_path, out)


def test_a_guarded_launch_is_not_guarded_again(tmp_path):
    with pytest.raises(InputError, match="starts a guard already"):
        out_of(tmp_path, "out.launch", NODE.format("rtron_guard"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<launch/>", "has changed since it was read"),
        ("<launch><include/></launch>", "has changed since it was read"),
        ("<launch>", "not XML"),
        ("<!DOCTYPE l [<!ENTITY e 'x'>]><launch>&e;</launch>", "has a document type"),
        ('<?xml version="1.0" encoding="nonsense"?><launch/>', "cannot be read"),
    ],
)
def test_a_file_that_is_no_longer_what_it_was_is_an_error(tmp_path, text, message):
    path = tmp_path / "app.launch"
    path.write_text(text)
    node = LaunchNode(name="/a", package="p", type="t", element_index=1)
    tree = LaunchTree(root=LaunchFile(path=str(path), nodes=(node,)))
    with pytest.raises(InputError, match=message):
        instrument_ros1(tree, plan_of(grcn(T, ["/a"], [])), tmp_path / "out.launch", GuardFiles(""))


def test_a_file_that_is_gone_is_an_error(tmp_path):
    tree = LaunchTree(root=LaunchFile(path=str(tmp_path / "app.launch")))
    with pytest.raises(InputError, match="cannot be read"):
        instrument_ros1(tree, plan_of(), tmp_path / "out.launch", GuardFiles(""))


@pytest.mark.parametrize("folder", ["a&b", r"a\1b", 'a"b', "a$(b"])
def test_a_folder_that_cannot_be_written_out_is_an_error(tmp_path, folder):
    (tmp_path / folder).mkdir()
    node = '<node pkg="p" type="t" name="n" args="$(dirname)"/>'
    with pytest.raises(InputError, match="lies in a folder"):
        out_of(tmp_path, "out.launch", node, name=f"{folder}/app.launch")


def test_such_a_folder_does_not_matter_where_nothing_means_it(tmp_path):
    (tmp_path / "a&b").mkdir()
    assert out_of(tmp_path, "out.launch", NODE.format("n"), name="a&b/app.launch").files
