"""Parameters of a launch, with no ROS: evidence, commands, conditions not known, hostile YAML."""

from pathlib import Path

import pytest
from file_tree import write
from launch_cases import NODE, included

from rtron.errors import InputError
from rtron.sources.launch.common import yaml_tree
from rtron.sources.launch.common.commands import CatCommand, XacroCommand, recognise_command
from rtron.sources.launch.ros1 import file_reader, parameter_server
from rtron.sources.launch.ros1.parameter_server import ParameterServer
from rtron.sources.launch.ros1.reader import read_launch, read_launches
from rtron.vocabulary import Evidence, Parameter, UnknownValue

UNKNOWN_IF = 'if="$(env NONE)"'
OF_ARG = '<param name="d" command="$(arg c)"/>'
UNKNOWN_UNLESS = 'unless="$(env NONE)"'


@pytest.fixture
def launch(tmp_path):
    """Return a function that writes a launch file, with other files beside it, and reads it."""

    def read(body, args=None, packages=None, describe=None, files=None):
        write(tmp_path, (files or {}))
        path = tmp_path / "app.launch"
        path.write_text(f"<launch>{body}</launch>")
        return read_launch(path, args or {}, packages or {}, {}, describe=describe)

    return read


def values(tree):
    return {name: found.value for name, found in tree.parameters.leaves.items()}


def unknown(tree, name):
    return isinstance(tree.parameters.leaves[name].value, UnknownValue)


def whys(tree):
    return [unresolved.why for unresolved in tree.unresolved]


def test_evidence_is_the_element_or_the_line_of_the_key(launch, tmp_path):
    tree = launch(
        '\n<param name="a" value="1"/>\n<rosparam>\nb: 1\nc:\n  d: 2\n</rosparam>'
        '<rosparam file="$(dirname)/p.yaml"/>',
        files={"p.yaml": "e:\n\n  f: 1\n  g:\n    - 2\nh: {i: 3}"},
    )
    lines = {name: found.evidence for name, found in tree.parameters.leaves.items()}
    app, yaml = str(tmp_path / "app.launch"), str(tmp_path / "p.yaml")
    assert lines == {
        "/a": Evidence(file=app, line=2),
        "/b": Evidence(file=app, line=4),
        "/c/d": Evidence(file=app, line=6),
        "/e/f": Evidence(file=yaml, line=3),
        "/e/g": Evidence(file=yaml, line=4),
        "/h/i": Evidence(file=yaml, line=6),
    }


@pytest.mark.parametrize(
    ("command", "expected"),
    [
        ("/opt/xacro/xacro.py a.xacro", XacroCommand(file="a.xacro")),
        ("xacro/xacro --inorder 'a b.xacro'", XacroCommand(file="a b.xacro")),
        ("xacro a.xacro --inorder x:=1 y:=' z '",
         XacroCommand(file="a.xacro", mappings={"x": "1", "y": "z"})),
        ("rosrun xacro xacro a.xacro x:=", XacroCommand(file="a.xacro", mappings={"x": ""})),
        ("python3 /opt/xacro.py a.xacro u:=a:=b",
         XacroCommand(file="a.xacro", mappings={"u": "a:=b"})),
        ("cat 'a b'", CatCommand(file="a b")),
        ("/bin/cat a", CatCommand(file="a")),
        ("cat a b", None),
        ("cat -", None),
        ("cat", None),
        ("xacro", None),
        ("xacro a b", None),
        ("xacro a.xacro -o b", None),
        ("xacro --deps a.xacro", None),
        ("rosrun xacro", None),
        ("rosrun", None),
        ("rm xacro a.xacro", None),
        ("bash -c 'xacro a'", None),
        ("'unfinished", None),
        ("", None),
    ],
)  # fmt: skip
def test_commands_are_recognised(command, expected):
    assert recognise_command(command) == expected


@pytest.mark.parametrize(
    "body",
    [
        '<param name="d" command="$(find xacro)/xacro.py --inorder \'$(dirname)/r.xacro\' x:=1"/>',
        f'<arg name="c" default="$(find xacro)/xacro $(dirname)/r.xacro x:=1"/>{OF_ARG}',
        '<param name="d" command="rosrun xacro xacro $(dirname)/r.xacro x:=1"/>',
    ],
)
def test_xacro_is_asked_for_and_never_run(launch, tmp_path, body):
    asked = []
    tree = launch(body, describe=lambda *call: asked.append(call) or "<robot/>")
    assert asked == [(tmp_path / "r.xacro", {"x": "1"})]
    assert (values(tree), tree.unresolved) == ({"/d": "<robot/>"}, ())


def test_without_xacro_the_description_is_not_known(launch, tmp_path):
    tree = launch('\n<param name="d" command="xacro r.xacro"/>')
    assert unknown(tree, "/d")
    assert whys(tree) == ["xacro is not evaluated: r.xacro"]
    assert tree.unresolved[0].evidence == (Evidence(file=str(tmp_path / "app.launch"), line=2),)


def fail(*_):
    raise InputError("broken", path="r.xacro", line=7)


def test_what_xacro_cannot_say_is_said(launch):
    body = '<param name="d" command="xacro r.xacro"/>'
    tree = launch(body, describe=lambda *_: UnknownValue("too deep"))
    assert (values(tree), whys(tree)) == ({"/d": UnknownValue("too deep")}, ["too deep"])
    tree = launch(body, describe=fail)
    assert tree.unresolved[0].evidence[1] == Evidence(file="r.xacro", line=7)


def test_other_commands_are_not_run(launch, tmp_path):
    tree = launch('<param name="a" command="touch $(dirname)/ran"/>')
    assert unknown(tree, "/a")
    assert not (tmp_path / "ran").exists()


@pytest.mark.parametrize("element", ["node", "group", "include"])
def test_what_may_start_is_read_and_said(launch, element):
    bodies = {
        "node": f'<node pkg="p" type="t" name="n" {UNKNOWN_IF}/>',
        "group": f"<group {UNKNOWN_UNLESS}>{NODE.format('n')}</group>",
        "include": f'<include file="$(dirname)/sub.launch" {UNKNOWN_IF}/>',
    }
    tree = launch(bodies[element], files={"sub.launch": included(NODE.format("n"))})
    assert [(node.name, node.conditional) for node in tree.nodes()] == [("/n", True)]
    assert len(tree.unresolved) == 1
    assert "read as if it did" in tree.unresolved[0].why


def test_two_nodes_of_one_name_are_fine_where_only_one_may_start(launch):
    body = "".join(
        f"<group {when}>{NODE.format('n')}</group>" for when in (UNKNOWN_IF, UNKNOWN_UNLESS)
    )
    tree = launch(body)
    assert [node.name for node in tree.nodes()] == ["/n", "/n"]
    assert len(tree.unresolved) == 2


def test_a_remap_or_env_that_may_count_is_left_out_and_said(launch):
    settings = f'<remap from="a" to="b" {UNKNOWN_IF}/><env name="E" value="1" {UNKNOWN_IF}/>'
    (node,) = launch(settings + NODE.format("n")).nodes()
    assert (node.remaps, node.environ, node.conditional) == ((), (), False)
    (node,) = launch(f'<node pkg="p" type="t" name="n">{settings}</node>').nodes()
    assert (node.remaps, node.environ) == ((), ())


def test_an_argument_that_may_be_set_is_not_known(launch):
    pair = f'<arg name="x" value="1" {UNKNOWN_IF}/><arg name="x" value="2" {UNKNOWN_UNLESS}/>'
    tree = launch(pair + '<param name="a" value="$(arg x)"/>' + NODE.format("n"))
    assert unknown(tree, "/a")
    assert len(tree.nodes()) == 1


def test_an_argument_given_from_outside_stays_known(launch):
    body = f'<arg name="x" default="1" {UNKNOWN_IF}/><param name="a" value="$(arg x)"/>'
    assert values(launch(body, args={"x": "5"})) == {"/a": 5}
    assert unknown(launch(body), "/a")


def test_an_argument_that_may_be_passed_does_not_lose_the_include(launch):
    body = f'<include file="$(dirname)/sub.launch"><arg name="x" value="1" {UNKNOWN_IF}/></include>'
    sub = included(
        '<arg name="x" default="2"/><param name="a" value="$(arg x)"/>' + NODE.format("n")
    )
    tree = launch(body, files={"sub.launch": sub})
    assert len(tree.nodes()) == 1
    assert unknown(tree, "/a")


def test_a_parameter_that_may_be_set_is_not_known(launch):
    param = f'<param name="a" value="1" {UNKNOWN_IF}/><rosparam {UNKNOWN_IF}>b: 1</rosparam>'
    tree = launch(param + f'<node pkg="p" type="t" name="n">{param}</node>')
    assert all(unknown(tree, name) for name in ("/a", "/b", "/n/a", "/n/b"))


def test_below_a_condition_only_a_contradiction_makes_a_parameter_unknown(launch):
    group = '<group {}><param name="a" value="{}"/><param name="b" value="1"/></group>'
    tree = launch(group.format(UNKNOWN_IF, 1) + group.format(UNKNOWN_UNLESS, 2))
    assert unknown(tree, "/a")
    assert values(tree)["/b"] == 1


def test_a_file_that_includes_itself_under_a_condition_ends_at_once(launch):
    tree = launch(NODE.format("n") + f'<include file="$(dirname)/app.launch" {UNKNOWN_IF}/>')
    assert len(tree.nodes()) == 1
    assert "includes itself" in whys(tree)[1]


def test_what_a_missing_file_would_set_is_not_known(launch):
    tree = launch(
        '<rosparam file="$(find none)/x.yaml" param="a"/><param name="b/c" value="1"/>'
        '<rosparam file="$(dirname)/no.yaml" ns="b"/>'
    )
    assert unknown(tree, "/a")
    assert values(tree)["/b/c"] == 1
    assert len(tree.unresolved) == 2


def test_a_parameter_file_that_its_package_lacks_is_missing(launch, tmp_path):
    tag = '<rosparam file="$(dirname)/no.yaml"/>'
    assert [note.missing for note in launch(tag).unresolved] == [""]
    tree = launch(tag, files={"package.xml": "<package><name>p</name></package>"})
    assert [note.missing for note in tree.unresolved] == [str(tmp_path / "no.yaml")]


def test_a_rosparam_node_sets_parameters_when_all_others_are_set(launch, tmp_path):
    load = '<node pkg="rosparam" type="rosparam" name="{}" ns="g" args="load $(dirname)/p.yaml{}"/>'
    nodes = {"r": "", "s": " h", "t": " /i", "u": " ~"}
    tree = launch(
        "".join(load.format(*node) for node in nodes.items())
        + '<param name="/g/a" value="0"/><param name="/g/c" value="0"/>',
        files={"p.yaml": "a: 1\nb: {d: 2}"},
    )
    below = {"a": 1, "b/d": 2}
    expected = {
        f"{ns}/{name}": value
        for ns in ("/g", "/g/h", "/i", "/g/u")
        for name, value in below.items()
    }
    assert values(tree) == {**expected, "/g/c": 0}
    assert tree.parameters.leaves["/g/b/d"].evidence == Evidence(
        file=str(tmp_path / "p.yaml"), line=2
    )


def test_a_rosparam_node_loads_several_documents_and_their_own_namespaces(launch):
    body = '<node pkg="rosparam" type="rosparam" name="r" args="load $(dirname)/p.yaml"/>'
    tree = launch(body, files={"p.yaml": "a: 1\n---\n_ns: x\nb: 2"})
    assert values(tree) == {"/a": 1, "/x/b": 2}


@pytest.mark.parametrize(
    "args", ["", "set a 1", "load", "load a b c", "load '", "load /no/such.yaml"]
)
def test_a_rosparam_node_that_is_not_understood_is_said(launch, args):
    tree = launch(f'<node pkg="rosparam" type="rosparam" name="r" args="{args}"/>')
    assert (len(tree.nodes()), values(tree), len(tree.unresolved)) == (1, {}, 1)


def test_launches_share_their_parameters(tmp_path):
    bodies = (
        '<param name="a" value="1"/><param name="b" value="$(arg x)"/>',
        '<param name="a" value="2"/>',
    )
    for number, body in enumerate(bodies):
        (tmp_path / f"{number}.launch").write_text(included(body))
    launches = [(tmp_path / "0.launch", {"x": "3"}), (tmp_path / "1.launch", {})]
    trees = read_launches(launches, {}, {})
    assert [values(tree) for tree in trees] == [{"/a": 2, "/b": 3}] * 2
    assert read_launches([], {}, {}) == ()


LAUGHS = "a0: &a0 [x, x]\n" + "".join(f"a{n}: &a{n} [*a{n - 1}, *a{n - 1}]\n" for n in range(1, 40))
MERGES = "a0: &a0 {}\n" + "".join(
    f"a{n}: &a{n} {{<<: [*a{n - 1}, *a{n - 1}]}}\n" for n in range(1, 40)
)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (LAUGHS, "values, counting what aliases repeat"),
        (MERGES, "values, counting what aliases repeat"),
        ("a: &a [*a]", "nested too deep"),
        ("a: &a {b: *a}", "nested too deep"),
        ("a: &a {<<: *a}", "nested too deep"),
        ("[" * 100_000, "more than 100 levels"),
        ("a: " + "{a: " * 101, "more than 100 levels"),
        ("a: \x00", "not YAML"),
        ("a: 1\n b: 2", "not YAML"),
        ("*no", "not YAML"),
    ],
)
def test_hostile_yaml_is_said_with_its_place(launch, tmp_path, text, why):
    tree = launch(
        '<rosparam file="$(dirname)/p.yaml" ns="x"/>' + NODE.format("n"), files={"p.yaml": text}
    )
    assert (len(tree.nodes()), unknown(tree, "/x")) == (1, True)
    assert why in tree.unresolved[0].why
    assert tree.unresolved[0].evidence[1].file == str(tmp_path / "p.yaml")
    assert tree.unresolved[0].evidence[1].line > 0


def test_a_fault_in_yaml_leaves_the_rest(launch, tmp_path):
    text = "a: 1\nb: !!python/name:os.system\nc: [2, !x 3]\n4: d\ne: null\nf: 5"
    tree = launch('<rosparam file="$(dirname)/p.yaml"/>', files={"p.yaml": text})
    assert (values(tree)["/a"], values(tree)["/f"], values(tree)["/c"][0]) == (1, 5, 2)
    assert unknown(tree, "/b")
    assert unknown(tree, "/e")
    assert isinstance(values(tree)["/c"][1], UnknownValue)
    lines = [unresolved.evidence[1].line for unresolved in tree.unresolved]
    assert lines == [2, 3, 4, 5]


@pytest.mark.parametrize(("extra", "is_yaml"), [(-1, True), (0, True), (1, False)])
def test_values_are_bounded(monkeypatch, extra, is_yaml):
    monkeypatch.setattr(yaml_tree, "MAX_VALUES", 10)
    text = f"[{', '.join('1' * (9 + extra))}]"
    if is_yaml:
        assert yaml_tree.parse_yaml(text, "p").errors == ()
    else:
        with pytest.raises(InputError, match="more than 10 values"):
            yaml_tree.parse_yaml(text, "p")


@pytest.mark.parametrize("file", ["/dev/zero", "/dev/stdin", "/", "$(dirname)"])
def test_what_is_no_file_is_not_read(launch, file):
    tree = launch(f'<param name="a" textfile="{file}"/><rosparam file="{file}" param="b"/>')
    assert unknown(tree, "/a")
    assert unknown(tree, "/b")


def test_text_that_is_not_utf_8_is_not_known(launch, tmp_path):
    (tmp_path / "t").write_bytes(b"\xff")
    assert unknown(launch('<param name="a" textfile="$(dirname)/t"/>'), "/a")


def test_a_node_knows_its_namespace(launch):
    tree = launch(NODE.format("n") + '<node pkg="p" type="t" name="m" ns="g/h"/>')
    assert [node.namespace for node in tree.nodes()] == ["/", "/g/h"]


@pytest.mark.parametrize("name", ["", "/", "//"])
def test_the_root_of_all_parameters_is_no_parameter(name):
    server = ParameterServer()
    server.set("/a", Parameter(value=1, evidence=Evidence(file="f")))
    server.set(name, Parameter(value=2, evidence=Evidence(file="f")))
    server.delete(name)
    assert list(server.parameters().leaves) == ["/a"]


def test_a_file_is_parsed_once_however_often_it_is_included(launch, monkeypatch):
    read = []
    real = Path.open
    monkeypatch.setattr(
        Path, "open", lambda self, *a, **k: read.append(self.name) or real(self, *a, **k)
    )
    include = '<include file="$(dirname)/sub.launch" ns="n{}"/>'
    sub = included('<rosparam file="$(dirname)/p.yaml"/>' + NODE.format("n"))
    tree = launch(
        "".join(map(include.format, range(50))), files={"sub.launch": sub, "p.yaml": "a: 1"}
    )
    assert len(tree.nodes()) == len(values(tree)) == 50
    assert (read.count("p.yaml"), read.count("sub.launch")) == (1 + 1, 1 + 1)


@pytest.mark.parametrize(("limit", "names"), [(2, ["/a", "/b"]), (3, ["/a", "/b", "/n/c"])])
def test_what_a_launch_sets_is_bounded_and_no_node_is_lost(launch, monkeypatch, limit, names):
    monkeypatch.setattr(parameter_server, "MAX_PARAMETERS", limit)
    node = '<node pkg="p" type="t" name="n"><param name="c" value="1"/></node>'
    tree = launch('<param name="a" value="1"/><rosparam>b: 1</rosparam>' + node)
    assert (list(values(tree)), len(tree.nodes())) == (names, 1)
    assert len(tree.unresolved) == 3 - len(names)


def test_what_rosparam_nodes_set_is_bounded(launch, monkeypatch):
    monkeypatch.setattr(parameter_server, "MAX_PARAMETERS", 3)
    node = '<node pkg="rosparam" type="rosparam" name="{}" args="load $(dirname)/p.yaml"/>'
    tree = launch(node.format("a") + node.format("b"), files={"p.yaml": "a: 1\nb: 2"})
    assert (len(tree.nodes()), len(tree.unresolved)) == (2, 1)


@pytest.mark.parametrize(("size", "is_read"), [(5, True), (6, False)])
def test_files_are_bounded_together(launch, monkeypatch, size, is_read):
    monkeypatch.setattr("rtron.sources.launch.ros1.parameter_server.MAX_TOTAL_BYTES", 10)
    body = '<param name="a" textfile="$(dirname)/t"/><param name="b" binfile="$(dirname)/t"/>'
    tree = launch(body, files={"t": "x" * size})
    assert (values(tree)["/a"], tree.unresolved == ()) == ("x" * size, is_read)


@pytest.mark.parametrize(("limit", "nodes"), [(4, 2), (3, 1)])
def test_elements_of_includes_are_bounded(launch, monkeypatch, limit, nodes):
    monkeypatch.setattr(file_reader, "MAX_ELEMENTS", limit)
    body = "".join(f'<include file="$(dirname)/sub.launch" ns="{ns}"/>' for ns in "ab")
    tree = launch(body, files={"sub.launch": included(NODE.format("n"))})
    assert (len(tree.nodes()), len(tree.unresolved)) == (nodes, 2 - nodes)


def test_files_outside_of_the_roots_are_not_read(tmp_path):
    secret = tmp_path / "secret.txt"
    secret.write_text("shadow")
    inside = tmp_path / "app"
    inside.mkdir()
    (inside / "link.txt").symlink_to(secret)
    launch = inside / "app.launch"
    launch.write_text(
        f"""<launch>
        <param name="a" textfile="{secret}"/>
        <param name="b" textfile="{inside}/link.txt"/>
        <param name="c" command="cat {secret}"/>
        <rosparam file="{secret}" param="d"/>
        <include file="{secret}"/>
        </launch>"""
    )
    (tree,) = read_launches([(launch, {})], {}, {}, roots=[inside])
    values = [tree.parameters.get(name).value for name in ("/a", "/b", "/c", "/d")]
    assert all(isinstance(value, UnknownValue) for value in values)
    assert "shadow" not in repr(tree)
    assert len(tree.unresolved) == 5
    assert all("lies outside" in note.why for note in tree.unresolved)
    assert not any(note.missing for note in tree.unresolved)
