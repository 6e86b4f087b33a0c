"""Files that include each other: across formats and packages, with what they are given."""

import pytest
from app_launch_values import names

CHILD = {
    "xml": """<launch><arg name="name" default="child"/>
        <node pkg="p" exec="e" name="$(var name)"/></launch>""",
    "yaml": """
launch:
- arg: {name: name, default: child}
- node: {pkg: p, exec: e, name: $(var name)}
""",
    "py": """
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
def generate_launch_description():
    return LaunchDescription([
        DeclareLaunchArgument('name', default_value='child'),
        Node(package='p', executable='e', name=LaunchConfiguration('name'))])
""",
}
SHARE = "os.path.join(get_package_share_directory('pkg'), 'launch', 'in.launch.{}')"


@pytest.fixture
def child(package):
    """Write the same launch file in each format; return their folder."""
    for suffix, text in CHILD.items():
        (package / "launch" / f"in.launch.{suffix}").write_text(text)
    return package / "launch"


@pytest.mark.parametrize(
    ("suffix", "source"),
    [
        *((suffix, "AnyLaunchDescriptionSource({})") for suffix in CHILD),
        *((suffix, "{}") for suffix in CHILD),
        ("py", "PythonLaunchDescriptionSource([{}])"),
        ("xml", "FrontendLaunchDescriptionSource({})"),
        ("yaml", "FrontendLaunchDescriptionSource({})"),
    ],
)
def test_a_python_file_includes_every_format(python, child, suffix, source):
    app = python(f"IncludeLaunchDescription({source.format(SHARE.format(suffix))})")
    assert names(app) == ["/child"]
    assert app.has_includes
    assert app.starts[0].evidence.file == str(child / f"in.launch.{suffix}")
    assert app.unresolved == ()


@pytest.mark.parametrize("suffix", ["xml", "yaml", "py"])
def test_an_xml_file_includes_every_format(xml, child, suffix):
    file = f"$(find-pkg-share pkg)/launch/in.launch.{suffix}"
    app = xml(f'<include file="{file}"><arg name="name" value="given"/></include>')
    assert names(app) == ["/given"]


@pytest.mark.parametrize(
    "given",
    ["{'name': 'x'}.items()", "[('name', 'x')]", "[('name', ['', LaunchConfiguration('a')])]"],
)
def test_what_an_included_file_is_given(python, child, given):
    include = f"IncludeLaunchDescription({SHARE.format('py')}, launch_arguments={given})"
    app = python(f"DeclareLaunchArgument('a', default_value='x'), {include}")
    assert names(app) == ["/x"]
    assert [one.name for one in app.arguments] == ["a"]


def test_what_an_included_file_sets_stays_unless_a_group_is_around(python, child):
    include = f"IncludeLaunchDescription({SHARE.format('py')}, launch_arguments=[('name', 'x')])"
    after = "Node(executable='e', name=[LaunchConfiguration('name', default='none'), '_2'])"
    assert names(python(f"{include}, {after}")) == ["/x", "/x_2"]
    assert names(python(f"GroupAction([{include}]), {after}")) == ["/x", "/none_2"]
    assert (
        names(python(f"{include}, IncludeLaunchDescription({SHARE.format('xml')})")) == ["/x"] * 2
    )


def test_a_namespace_around_an_included_file(python, child):
    include = f"IncludeLaunchDescription({SHARE.format('py')})"
    assert names(python(f"GroupAction([PushRosNamespace('ns'), {include}])")) == ["/ns/child"]


def test_a_file_included_under_a_condition(python, child):
    include = "IncludeLaunchDescription({}, condition=IfCondition('{}'))"
    off, on = (include.format(SHARE.format("py"), said) for said in ("false", "true"))
    app = python(f"{off}, {on}")
    assert names(app) == ["/child"]


@pytest.mark.parametrize(
    ("file", "why", "missing"),
    [
        ("'/nowhere/x.launch.py'", "is no file", "/nowhere/x.launch.py"),
        ("'/nowhere/x.launch.xml'", "No such file", "/nowhere/x.launch.xml"),
        ("os.path.join(get_package_share_directory('no'), 'x.py')", "what it includes is not known",
         ""),
        ("[LaunchConfiguration('dir'), '/x.py']", "argument 'dir' is not given", ""),
    ],
)  # fmt: skip
def test_a_file_that_is_not_here_is_noted_and_the_rest_is_read(python, file, why, missing):
    app = python(f"IncludeLaunchDescription({file}), Node(executable='e', name='n')")
    assert names(app) == ["/n"]
    noted = [note for note in app.unresolved if why in note.why]
    assert [(note.missing, note.hides) for note in noted] == [(missing, "nodes")]


@pytest.mark.parametrize("name", ["no", "pkg"])
@pytest.mark.parametrize(
    "file",
    [
        "os.path.join(get_package_share_directory('{}'), 'x.py')",
        "PathJoinSubstitution([FindPackageShare('{}'), 'launch', 'x.py'])",
    ],
)
@pytest.mark.usefixtures("package")
def test_the_package_of_a_file_that_is_not_here_is_noted(python, file, name):
    notes = python(f"IncludeLaunchDescription({file.format(name)})").unresolved
    assert [note.package for note in notes if note.package] == [name]


def test_a_file_that_the_build_installs_in_another_folder(python, package):
    (package / "deep").mkdir()
    (package / "deep" / "x.launch.xml").write_text(CHILD["xml"])
    app = python("IncludeLaunchDescription([FindPackageShare('pkg'), '/launch/x.launch.xml'])")
    assert names(app) == ["/child"]
    assert app.starts[0].evidence.file == str(package / "deep" / "x.launch.xml")


def test_files_in_files(python, package, child):
    (package / "launch" / "mid.launch.xml").write_text(
        '<launch><include file="$(dirname)/in.launch.py"/></launch>'
    )
    app = python("IncludeLaunchDescription([ThisLaunchFileDir(), '/mid.launch.xml'])")
    assert app.starts[0].evidence.file == str(child / "in.launch.py")


def test_a_helper_module_beside_the_launch_file(program, package):
    (package / "launch" / "robot_parts.py").write_text("""
from launch_ros.actions import Node
TOPIC = '/cmd_vel'
def driver(name, **more):
    return Node(package='p', executable='e', name=name, remappings=[('out', TOPIC)], **more)
""")
    app = program("""
from robot_parts import driver
def generate_launch_description():
    return LaunchDescription([driver('left'), driver('right', namespace='r')])
""")
    assert names(app) == ["/left", "/r/right"]
    assert app.starts[0].remaps == (("out", "/cmd_vel"),)
    assert app.starts[0].evidence.file.endswith("robot_parts.py")


def leaks(app):
    """Return the arguments that come from a file before: how sure, the name, and the values."""
    return [(str(f.kind), f.subject, f.value, *f.others[2:]) for f in app.wiring]


@pytest.fixture
def included(package, xml):
    """Return what a file leaks that has these elements; `NAME.xml` includes a file beside it."""

    def read(text, **files):
        for name, elements in files.items():
            (package / "launch" / f"{name}.xml").write_text(f"<launch>{elements}</launch>")
        for name in files:
            path = f'<include file="$(find-pkg-share pkg)/launch/{name}.xml"'
            text = text.replace(f"<{name}", path).replace(f"</{name}>", "</include>")
        return leaks(xml(text))

    return read


USE = '<let name="scan" value="$(var topic)"/>'
FRONT, REAR = (f'<arg name="topic" default="{each}/scan"/>{USE}' for each in ("front", "rear"))
LEAK = ("leaked_argument", "topic", "front/scan", "rear/scan")


def test_a_default_stays_set_for_the_file_after_it(included):
    assert included("<front/><rear/>", front=FRONT, rear=REAR) == [LEAK]


@pytest.mark.parametrize(
    "text",
    [
        "<group><front/></group><rear/>",
        '<front/><rear><arg name="topic" value="rear/given"/></rear>',
        '<front/><let name="topic" value="both/scan"/><rear/>',
        '<arg name="topic" default="both/scan"/><front/><rear/>',
        '<front><arg name="topic" value="rear/scan"/></front><rear/>',
        "<front/><group><reset/><rear/></group>",
        "<push_vars/><front/><pop_vars/><rear/>",
    ],
)
def test_what_is_meant_for_a_file_does_not_leak(included, text):
    assert included(text, front=FRONT, rear=REAR) == []


PUSH = '<arg name="robot"/><push_ros_namespace namespace="$(var robot)"/>'


def test_a_namespace_that_is_pushed_outside_of_a_group_stays_for_the_file_after_it(included):
    one, two = (f'<front><arg name="robot" value="{name}"/></front>' for name in ("a", "b"))
    leak = ("ros_namespace", "/a", "/")
    assert included(one + two, front=PUSH) == [("leaked_argument", *leak)]
    other = one + two.replace("front", "rear")
    assert included(other, front=PUSH, rear=PUSH) == [("possible_leaked_argument", *leak)]
    assert included(f"<group>{one}</group>{two}", front=PUSH) == []
    assert included(one + two.replace('"b"', '"/b"'), front=PUSH) == []
    assert included(one + two, front=f"<group>{PUSH}</group>") == []


def test_a_default_of_a_file_within_leaks_too_but_not_into_its_own(included):
    inner = '<include file="$(find-pkg-share pkg)/launch/inner.xml"/>'
    files = {"front": FRONT + inner, "inner": FRONT.replace("front", "inner"), "rear": REAR}
    assert included("<front/><rear/>", **files) == [LEAK]


def test_what_another_file_was_given_may_be_meant_for_both(included):
    given = '<front><arg name="topic" value="given/scan"/></front><rear/>'
    expected = [("possible_leaked_argument", "topic", "given/scan", "rear/scan")]
    assert included(given, front=FRONT, rear=REAR) == expected
    expected = [("leaked_argument", "topic", "given/scan", "front/scan")]
    assert included(given.replace("rear", "front"), front=FRONT) == expected


def test_an_argument_that_the_file_does_not_use_is_possible_only(included):
    files = {"front": FRONT, "rear": REAR.replace(USE, "")}
    assert included("<front/><rear/>", **files) == [("possible_leaked_argument", *LEAK[1:])]


@pytest.mark.parametrize("is_used", [True, False])
def test_a_python_file_uses_an_argument_by_its_configuration(included, package, is_used):
    used = f"LaunchConfiguration(\n{' ' * 8}'topic')" if is_used else "''"
    (package / "launch" / "rear.launch.py").write_text(f"""from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, LogInfo
from launch.substitutions import LaunchConfiguration


def generate_launch_description():
    topic = DeclareLaunchArgument('topic', default_value='rear/scan')
    return LaunchDescription([topic, LogInfo(msg={used})])
""")
    rear = '<include file="$(find-pkg-share pkg)/launch/rear.launch.py"/>'
    expected = "leaked_argument" if is_used else "possible_leaked_argument"
    assert included(f"<front/>{rear}", front=FRONT) == [(expected, *LEAK[1:])]


def test_what_is_pushed_and_popped_does_not_leak(package, program):
    for name, text in (("front", FRONT), ("rear", REAR)):
        (package / "launch" / f"{name}.xml").write_text(f"<launch>{text}</launch>")
    text = """from launch import LaunchDescription
from launch.actions import (
    IncludeLaunchDescription, PopLaunchConfigurations, PushLaunchConfigurations)
from launch.launch_description_sources import AnyLaunchDescriptionSource
from launch_ros.substitutions import FindPackageShare


def include(name):
    path = [FindPackageShare('pkg'), f'/launch/{name}.xml']
    return IncludeLaunchDescription(AnyLaunchDescriptionSource(path))


def generate_launch_description():
    return LaunchDescription([
        PushLaunchConfigurations(), include('front'), PopLaunchConfigurations(), include('rear')])
"""
    assert leaks(program(text)) == []
    assert leaks(program(text.replace("PopLaunchConfigurations(), ", ""))) == [LEAK]


@pytest.mark.parametrize(("one", "other"), [("10", "10.0"), ("1", "true"), ("False", "0")])
def test_the_same_value_written_otherwise_does_not_leak(included, one, other):
    files = {"front": FRONT.replace("front/scan", one), "rear": REAR.replace("rear/scan", other)}
    assert not included("<front/><rear/>", **files)


def test_a_switch_is_likely_meant_for_all(included):
    on, off = (f'<arg name="sim" default="{each}"/>' for each in ("True", "false"))
    expected = [("possible_leaked_argument", "sim", "True", "false")]
    assert included("<front/><rear/>", front=on, rear=off) == expected
    assert not included("<front/><rear/>", front=on, rear=on.replace("True", "true"))
    given = '<front><arg name="sim" value="true"/></front><rear/>'
    assert not included(given, front=off, rear=off)


@pytest.mark.parametrize(
    ("text", "front"),
    [
        ("<front/><rear/>", FRONT.replace("front", "$(env UNKNOWN)")),
        ("<front/><rear/>", FRONT.replace("front/scan", "")),
        ('<front if="$(env UNKNOWN)"/><rear/>', FRONT),
    ],
)
def test_what_is_known_only_at_run_time_is_no_leak(included, text, front):
    assert included(text, front=front, rear=REAR) == []


NEAR = '<arg name="map_file" default="y"/>'
UNKNOWN = '<front><arg name="file" value="x"/></front>'


@pytest.mark.parametrize("name", ["map_file", "files"])
def test_an_argument_that_a_file_does_not_know_and_that_is_near_one(included, name):
    front = f'<arg name="{name}" default="y"/>'
    assert included(UNKNOWN, front=front) == [("undeclared_argument", "file", name)]


@pytest.mark.parametrize(
    "front",
    [
        '<arg name="profile" default="y"/>',
        f'{NEAR}<let name="a" value="$(var file)"/>',
        f'{NEAR}<arg name="file" default="z" if="false"/>',
        f'{NEAR}<include file="$(find-pkg-share gone)/a.xml"/>',
        f'{NEAR}<include file="/gone.xml"/>',
        f"{NEAR}<!-- launch_configurations of all -->",
        '<arg name="file_path" default="y"/>',
        '<arg name="use_file" default="y"/>',
        f'{NEAR}<include file="$(find-pkg-share pkg)/launch/inner.xml"/>',
    ],
)
def test_an_argument_that_may_be_known_or_is_near_none(included, front):
    inner = '<arg name="file" default="z"/>'
    assert included(UNKNOWN, front=front, inner=inner) == []


def test_an_argument_that_is_near_one_that_is_given_too(included):
    text = UNKNOWN.replace("</front>", '<arg name="map_file" value="z"/></front>')
    assert included(text, front=NEAR) == []


def test_of_many_arguments_few_are_compared(included):
    declared = "".join(f'<arg name="{each:03}" default="y"/>' for each in range(100))
    given = "".join(f'<arg name="file{each}" value="x"/>' for each in range(9))
    near = NEAR.replace("map_file", "files")
    assert included(f"<front>{given}</front>", front=declared + near) == []
    assert len(included(f"<front>{given}</front>", front=near)) == 5


GIVEN_NOWHERE = '<let name="a" value="$(var topic)"/>'


def test_an_argument_that_nobody_gives(included):
    for front in (GIVEN_NOWHERE, '<arg name="topic"/>', GIVEN_NOWHERE * 2):
        ((kind, name, file),) = included("<front/>", front=front)
        assert (kind, name, file.rpartition("/")[2]) == ("missing_argument", "topic", "front.xml")


def test_what_the_first_file_declares_without_a_default_is_for_the_user_to_give(included):
    assert included('<arg name="robot_ip"/><front/>', front="<group/>") == []


@pytest.mark.parametrize(
    ("text", "front"),
    [
        ('<front><arg name="topic" value="x"/></front>', GIVEN_NOWHERE),
        ('<let name="topic" value="x"/><front/>', GIVEN_NOWHERE),
        ("<front/>", GIVEN_NOWHERE.replace("topic", "topic x")),
        ('<front if="$(env UNKNOWN)"/>', GIVEN_NOWHERE),
        ('<include file="/gone.xml"/><front/>', GIVEN_NOWHERE),
        ("<front/>", f"{GIVEN_NOWHERE}<unknown_action/>"),
    ],
)
def test_an_argument_that_may_be_given_or_not_be_used(included, text, front):
    assert included(text, front=front) == []


def test_an_argument_that_a_person_gives_is_not_missing(read):
    text = f"<launch>{GIVEN_NOWHERE}</launch>"
    assert [fact.subject for fact in read(text, "xml").wiring] == ["topic"]
    assert read(text, "xml", topic="x").wiring == ()
