"""Reading launch files, with no ROS: what a LaunchTree says beyond names and remaps."""

import pytest
from launch_cases import CASES, INCLUDES, NODE, included

from rtron.errors import InputError
from rtron.sources.launch.common.xml_document import MAX_BYTES
from rtron.sources.launch.ros1 import file_reader
from rtron.sources.launch.ros1.reader import read_launch
from rtron.vocabulary import Evidence, Remap


@pytest.fixture
def launch(tmp_path):
    """Return a function that writes a launch file, with others beside it, and reads it."""

    def read(body, args=None, packages=None, environ=None, **files):
        for name, text in files.items():
            (tmp_path / f"{name}.launch").write_text(text)
        path = tmp_path / "app.launch"
        path.write_text(f"<launch>{body}</launch>")
        return read_launch(path, args or {}, packages or {}, environ or {})

    return read


def names(tree):
    return [node.name for node in tree.nodes()]


def test_a_node_knows_its_element_and_line(launch):
    (node,) = launch('\n<!-- <x/> -->\n<group>\n<node pkg="p" type="t" name="n"/></group>').nodes()
    assert (node.element_index, node.line, node.anonymous) == (2, 4, False)
    assert (node.package, node.type, node.args) == ("p", "t", "")


def test_elements_count_from_the_root_of_the_document(tmp_path):
    path = tmp_path / "app.launch"
    path.write_text(f"<a><b/><launch>{NODE.format('n')}</launch></a>")
    assert read_launch(path, {}, {}, {}).nodes()[0].element_index == 3


def test_a_remap_keeps_its_spelling(launch):
    node = '<node pkg="p" type="t" name="n" ns="g"><remap from="~a//b/" to="c"/></node>'
    (remap,) = launch(node).nodes()[0].remaps
    assert remap == Remap(
        written_source="~a/b", written_target="c", source="/g/n/a/b", target="/g/c"
    )


def test_an_anonymous_name_is_a_pattern(launch):
    remap = '<remap from="/$(anon n)/a" to="/$(anon n)/b"/>'
    start = '<node pkg="p" type="t" name="$(anon n)" ns="g" args="$(anon n)">'
    (node,) = launch(f"{start}{remap}</node>").nodes()
    assert (node.name, node.anonymous, node.args) == ("/g/n_*", True, "n_*")
    assert node.remaps[0].target == "/n_*/b"


def test_a_file_included_twice_stands_in_the_tree_twice(launch, tmp_path):
    tree = launch(
        '<include file="$(dirname)/sub.launch" ns="a"/><include file="$(dirname)/sub.launch"/>',
        sub=included(NODE.format("n")),
    )
    assert [include.element_index for include in tree.root.includes] == [1, 2]
    assert [file.path for file in tree.root.walk()] == [
        str(tmp_path / name) for name in ("app.launch", "sub.launch", "sub.launch")
    ]
    assert names(tree) == ["/a/n", "/n"]


def test_a_path_keeps_the_spelling_that_roslaunch_opens(launch, tmp_path):
    (tmp_path / "s").mkdir()
    tree = launch('<include file="$(dirname)/s/../sub.launch"/>', sub=included(""))
    assert tree.root.includes[0].file.path == f"{tmp_path}/s/../sub.launch"


def test_a_relative_include_is_taken_from_the_current_directory(launch, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    tree = launch('<include file="sub.launch"/>', sub=included(NODE.format("n")))
    assert names(tree) == ["/n"]


def test_an_optional_variable_keeps_the_kind_of_its_default_in_an_expression(launch):
    body = NODE.format("$(eval 'omni' if int(optenv('OMNI', 0)) else 'n%s' % (optenv('N', 1) + 1))")
    assert names(launch(body)) == ["/n2"]
    assert names(launch(body, environ={"OMNI": "1"})) == ["/omni"]


def test_a_missing_package_leaves_out_the_include_and_says_so(launch, tmp_path):
    tree = launch(f'\n<include file="$(find none)/x.launch"/>{NODE.format("n")}')
    (unresolved,) = tree.unresolved
    assert names(tree) == ["/n"]
    assert tree.root.includes == ()
    assert unresolved.what == "include $(find none)/x.launch"
    assert (unresolved.why, unresolved.missing) == ("package 'none' is not found", "")
    assert (unresolved.hides, unresolved.package) == ("nodes", "none")
    assert unresolved.evidence == (Evidence(file=str(tmp_path / "app.launch"), line=2),)


def test_a_missing_file_is_named_with_where_it_is_included(launch, tmp_path):
    (tmp_path / "package.xml").write_text("<package><name>pkg</name></package>")
    tree = launch('<include file="$(dirname)/no.launch"/>')
    (unresolved,) = tree.unresolved
    assert tree.root.includes == ()
    assert [evidence.file for evidence in unresolved.evidence] == [
        str(tmp_path / "app.launch"),
        str(tmp_path / "no.launch"),
    ]
    assert (unresolved.missing, unresolved.package) == (str(tmp_path / "no.launch"), "pkg")


@pytest.mark.parametrize("name", ["no.urdf.xacro", "no"])
def test_only_a_launch_file_is_missed(launch, name):
    (unresolved,) = launch(f'<include file="$(dirname)/{name}"/>').unresolved
    assert unresolved.missing == ""


def test_what_was_read_before_a_fault_in_an_include_stays(launch, tmp_path):
    broken = included(NODE.format("n") + "\n<node/>" + NODE.format("m"))
    tree = launch('<include file="$(dirname)/sub.launch"/>' + NODE.format("o"), sub=broken)
    assert names(tree) == ["/o", "/n"]
    assert tree.unresolved[0].evidence[1] == Evidence(file=str(tmp_path / "sub.launch"), line=2)


def test_an_argument_that_cannot_be_resolved_counts_only_where_it_is_used(launch):
    tree = launch(
        '<arg name="a" default="$(find none)/x"/><arg name="b" default="$(arg a)"/>'
        '<arg name="c" default="$(env NONE)"/>'
        '<include file="$(dirname)/sub.launch"><arg name="p" value="$(arg b)"/></include>',
        sub=included('<arg name="p"/><node pkg="p" type="t" name="n" args="$(arg p)"/>'),
    )
    assert [(u.what, u.why) for u in tree.unresolved] == [("node n", "package 'none' is not found")]
    assert tree.unresolved[0].hides is None
    assert tree.nodes()[0].args == "$(arg p)"


@pytest.mark.parametrize(
    "body",
    [
        NODE.format("$(env NONE)"),
        f'<group ns="$(env NONE)">{NODE.format("n")}</group>',
        '<arg name="x" default="$(find none)"/>' + NODE.format("$(eval x)"),
        NODE.format("$(eval [x for x in (1, 2)])"),
    ],
)
def test_a_node_of_unknown_name_or_namespace_is_left_out_and_said(launch, body):
    tree = launch(body)
    assert names(tree) == []
    assert len(tree.unresolved) == 1


def test_a_remap_that_cannot_be_resolved_leaves_its_node(launch):
    remap = '<remap from="a" to="$(env NONE)"/><remap from="b" to="c"/>'
    tree = launch(f'<node pkg="p" type="t" name="n">{remap}</node>')
    assert [remap.written_source for remap in tree.nodes()[0].remaps] == ["b"]
    assert tree.unresolved[0].what == "remap a"


def test_two_nodes_of_one_name_are_said(launch):
    tree = launch(NODE.format("n") * 2 + NODE.format("$(anon m)") * 2)
    assert [unresolved.what for unresolved in tree.unresolved] == ["node /n"]


def test_every_missing_argument_is_listed(launch, tmp_path):
    body = '<arg name="z" default="1"/>\n<arg name="x"/><arg name="y"/>' + NODE.format("$(arg y)")
    with pytest.raises(InputError, match=r"needs a value for x, y$") as caught:
        launch(body)
    assert (caught.value.line, caught.value.help) == (2, "give x:=… y:=…")


def test_an_argument_that_is_not_declared_either_is_listed_too(launch):
    with pytest.raises(InputError, match="needs a value for x, undeclared"):
        launch('<arg name="x"/>' + NODE.format("$(arg undeclared)"))


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<launch>", "not XML"),
        ("", "not XML"),
        ("<robot/>", "has 0 <launch> elements"),
        ("<!DOCTYPE launch>\n<launch/>", "has a document type"),
        ('<!DOCTYPE l [<!ENTITY e SYSTEM "file:///etc/passwd">]><launch>&e;</launch>', "document"),
        ("<launch>&e;</launch>", "not XML"),
        (f"<launch>{' ' * MAX_BYTES}</launch>", "larger than 1 MiB"),
    ],
)
def test_what_is_no_launch_file_is_an_error_with_its_path(tmp_path, text, message):
    path = tmp_path / "app.launch"
    path.write_text(text)
    with pytest.raises(InputError, match=message) as caught:
        read_launch(path, {}, {}, {})
    assert caught.value.path == str(path)


def test_entities_that_multiply_are_an_error(tmp_path):
    levels = range(1, 12)
    entities = "".join(f"<!ENTITY e{n} '{f'&e{n - 1};' * 10}'>" for n in levels)
    path = tmp_path / "app.launch"
    path.write_text(f"<!DOCTYPE l [<!ENTITY e0 'x'>{entities}]><launch a='&e11;'/>")
    with pytest.raises(InputError):
        read_launch(path, {}, {}, {})


def test_a_missing_root_is_an_error(tmp_path):
    with pytest.raises(InputError, match="No such file"):
        read_launch(tmp_path / "no.launch", {}, {}, {})


def test_an_include_of_itself_ends(launch):
    tree = launch(NODE.format("$(anon n)") + '<include file="$(dirname)/app.launch"/>')
    assert len(tree.nodes()) == file_reader.MAX_DEPTH + 1
    assert len(tree.unresolved) == 1


def test_includes_that_multiply_end(launch, monkeypatch):
    monkeypatch.setattr(file_reader, "MAX_FILES", 100)
    tree = launch('<include file="$(dirname)/app.launch"/>' * 3)
    assert len(list(tree.root.walk())) == 101
    assert tree.unresolved


def test_groups_too_deep_are_refused(launch):
    assert launch("<group>" * 50 + "</group>" * 50).unresolved == ()
    with pytest.raises(InputError, match="not XML"):
        launch("<group>" * 300 + "</group>" * 300)
    deep = "<group>" * 50 + '<include file="$(dirname)/app.launch"/>' + "</group>" * 50
    with pytest.raises(InputError, match="nested too deep"):
        launch(deep)


@pytest.mark.parametrize("special", ["/dev/zero", "/dev/stdin", "/"])
def test_an_include_of_what_is_no_file_is_not_read(launch, special):
    assert "is no file" in launch(f'<include file="{special}"/>').unresolved[0].why


def test_arguments_that_multiply_end(launch):
    doubling = '<arg name="a{}" default="$(arg a{})$(arg a{})"/>'
    args = "".join(doubling.format(n + 1, n, n) for n in range(64))
    tree = launch('<arg name="a0" default="x"/>' + args + NODE.format("$(arg a64)"))
    assert "too long" in tree.unresolved[0].why


@pytest.mark.parametrize("case", [*CASES, *INCLUDES], ids=lambda case: case.name)
def test_reading_twice_gives_the_same(tmp_path, case):
    path = tmp_path / "app.launch"
    path.write_text(f"<launch>{case.body}</launch>")
    environ = {"WHO": "me", **case.environ}
    assert read_launch(path, case.args, {}, environ) == read_launch(path, case.args, {}, environ)
