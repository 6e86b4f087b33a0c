"""Parameters that a launch sets and the node that it starts does not declare."""

from pathlib import Path

import pytest
from file_tree import write

from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.ros2.app import scan_ros2_app

MANIFEST = "<package><name>app</name></package>"
SETUP = """from setuptools import setup
setup(name="app", entry_points={"console_scripts": ["base = app.base:main", "arm = app.arm:main"]})
"""
NODE = """import rclpy
from rclpy.node import Node
class Made(Node):
    def __init__(self):
        super().__init__({name!r})
{body}
def main():
    rclpy.init()
    rclpy.spin(Made())
"""
LAUNCH = """from launch import LaunchDescription
from launch_ros.actions import Node
def generate_launch_description():
    return LaunchDescription([
        Node(package="app", executable="base", parameters=[{given}]),
        Node(package="app", executable="arm", parameters=[{given}]),
    ])
"""
BASE = ("max_vel", "wheel.radius", "rate")


@pytest.fixture
def scanned(tmp_path):
    """Return the graph of two nodes that declare some parameters and are given others."""

    def scan(given, base=BASE, arm=("speed",), more="pass"):
        files = {"package.xml": MANIFEST, "setup.py": SETUP, "app/__init__.py": ""}
        for name, declared in (("base", base), ("arm", arm)):
            lines = [f"self.declare_parameter({each!r}, 1.0)" for each in declared] + [more]
            body = "\n".join(f"        {line}" for line in lines)
            files[f"app/{name}.py"] = NODE.format(name=name, body=body)
        write(tmp_path, files)
        (tmp_path / "p.yaml").write_text(given if isinstance(given, str) else "")
        launch = tmp_path / "app.launch.py"
        words = repr(str(tmp_path / "p.yaml")) if isinstance(given, str) else repr(given)
        launch.write_text(LAUNCH.replace("{given}", words))
        return scan_ros2_app([tmp_path], [(launch, {})], {}, ScanOptions(workers=1))

    return scan


@pytest.fixture
def unread(scanned, tmp_path):
    """Return what the nodes ignore of the parameters that are given, with what they declare."""

    def facts(given, **declared):
        graph = scanned(given, **declared)
        kinds = ("misspelt_parameter", "unread_parameter")
        found = [fact for fact in graph.wiring if fact.kind in kinds]
        file, launch = str(tmp_path / "p.yaml"), str(tmp_path / "app.launch.py")
        places = [file, launch] if isinstance(given, str) else [launch]
        assert all([place.file for place in fact.evidence] == places for fact in found)
        return {(fact.subject, fact.value): fact.others for fact in found}

    return facts


def without_node(graph):
    """Return the sections of parameters that no node has, with the near names."""
    facts = (fact for fact in graph.wiring if fact.kind == "section_without_node")
    return [(fact.subject, fact.others) for fact in facts]


def of_base(**values):
    lines = "".join(f"    {name}: {value}\n" for name, value in values.items())
    return f"/base:\n  ros__parameters:\n{lines}"


def test_a_near_name_that_nobody_sets_is_named(unread):
    assert unread(of_base(max_vell=1.0)) == {("/base", "max_vell"): ("max_vel",)}


@pytest.mark.parametrize("name", ["maxVel", "_max_vel", "MAX_VEL", "max_vels"])
def test_near_is_another_spelling(unread, name):
    assert unread(of_base(**{name: 1.0})) == {("/base", name): ("max_vel",)}


@pytest.mark.parametrize("name", ["vel", "wheel.max_vel", "max_acceleration"])
def test_another_word_or_group_is_not_near(unread, name):
    assert unread(of_base(**{name: 1.0})) == {("/base", name): ()}


def test_a_near_name_that_is_set_too_is_not_meant(unread):
    assert unread(of_base(max_vell=1.0, max_vel=2.0)) == {("/base", "max_vell"): ()}


def test_a_near_name_is_near_to_one_only(unread):
    assert unread(of_base(max_vell=1.0, max_velocs=1.0, rat=1.0, other=2)) == {
        ("/base", "max_vell"): ("max_vel",),
        ("/base", "rat"): ("rate",),
        ("/base", "max_velocs"): (),
        ("/base", "other"): (),
    }


def test_what_is_declared_is_read(unread):
    assert unread(of_base(max_vel=1.0, rate=2.0)) == {}
    assert unread("base:\n  ros__parameters:\n    wheel:\n      radius: 1.0\n") == {}


@pytest.mark.parametrize("name", ["use_sim_time", "qos_overrides./scan.subscription.depth"])
def test_what_every_node_reads_is_read(unread, name):
    assert unread(of_base(**{name: 1})) == {}


def test_what_is_for_all_nodes_is_read_if_one_declares_it(unread):
    assert unread("/**:\n  ros__parameters:\n    speed: 1.0\n    max_vel: 1.0\n") == {}
    ignored = unread("/**:\n  ros__parameters:\n    sped: 1.0\n    other: 1.0\n")
    assert ignored == {("/arm", "sped"): ("speed",)}


def test_of_a_node_that_declares_none_nothing_is_known(unread):
    assert unread(of_base(max_vel=1.0), base=()) == {}


@pytest.mark.parametrize(
    "more",
    [
        "self.declare_parameter(unknown(), 1.0)",
        "[self.declare_parameter(f'max_{each}', 1.0) for each in unknown()]",
        "exec(unknown())",
    ],
)
def test_of_a_node_that_was_not_read_whole_nothing_is_known(unread, more):
    assert unread(of_base(max_vell=1.0), more=more) == {}


@pytest.mark.parametrize(
    ("section", "near"),
    [("/bas", "/base"), ("/basse", "/base"), ("/base", None), ("/camera", None), ("/**", None)],
)
def test_a_section_for_a_name_that_no_node_has(scanned, section, near):
    graph = scanned(f"{section}:\n  ros__parameters:\n    max_vel: 1.0\n")
    assert without_node(graph) == ([(section, (near,))] if near else [])
    places = [place for fact in graph.wiring for place in fact.evidence if near]
    assert [(Path(place.file).name, place.line) for place in places] == (
        [("p.yaml", 3), ("app.launch.py", 5)] if near else []
    )


def test_a_node_with_a_section_of_its_own_is_not_meant(scanned):
    graph = scanned(of_base(max_vel=1.0) + "/bas:\n  ros__parameters:\n    max_vel: 1.0\n")
    assert not without_node(graph)


def test_a_node_that_is_given_parameters_for_all_is_not_meant(scanned):
    given = "/**:\n  ros__parameters:\n    rate: 1.0\n/bas:\n  ros__parameters:\n    rate: 2.0\n"
    assert not without_node(scanned(given))


def test_very_many_names_are_not_compared(unread):
    many = {f"n{number}": 1 for number in range(4000)}
    assert unread(of_base(max_vell=1.0, **many))["/base", "max_vell"] == ()


TWO = "{ros__parameters: {max_vel: 1.0, rate: 2.0}}"


@pytest.mark.parametrize(
    ("section", "arm", "meant"),
    [
        (f"/drive: {TWO}", ("speed",), [("/drive", ("/base",))]),
        (f"/drive: {TWO.replace('max_vel', 'x: 1, max_vel')}", (), [("/drive", ("/base",))]),
        (f"/drive: {TWO.replace('max_vel', 'x: 1, y: 2, max_vel')}", (), []),
        ("/drive: {ros__parameters: {max_vel: 1.0}}", (), []),
        ("/drive: {ros__parameters: {use_sim_time: true}}", (), []),
        (f"/*: {TWO}", (), []),
        (of_base(rate=1.0) + f"/drive: {TWO}", (), []),
        (f"/drive: {TWO}", ("max_vel", "rate"), []),
        (f"/armm: {TWO}", ("speed",), [("/armm", ("/base",))]),
    ],
)
def test_a_section_is_meant_for_the_one_node_that_declares_most_of_it(scanned, section, arm, meant):
    assert without_node(scanned(section, arm=arm)) == meant


def test_a_parameter_of_the_launch_itself_is_no_section(scanned, tmp_path):
    scanned("/drive:\n  ros__parameters:\n    max_vel: 1.0\n    rate: 2.0\n", arm=())
    launch = tmp_path / "app.launch.py"
    more = "{'wheel.radius': 2.0}"
    launch.write_text(launch.read_text().replace("parameters=[", f"parameters=[{more}, "))
    graph = scan_ros2_app([tmp_path], [(launch, {})], {}, ScanOptions(workers=1))
    assert without_node(graph) == [("/drive", ("/base",))]


EKF = "robot_localization/ekf_node"
PROGRAM = """Node(package={package!r}, executable={program!r}, {name}
    parameters=[{file!r}{more}]),
"""


@pytest.mark.parametrize(
    ("program", "section", "names", "more", "meant"),
    [
        (EKF, "ekf_filter_node", ("odometry",), "", "/odometry"),
        (EKF, "ekf_filter_node", ("odometry",), ", {'use_sim_time': True}", "/odometry"),
        (EKF, "ekf_filter_node", ("odometry",), ", {'frequency': 9.0}", None),
        (EKF, "ekf_filter_node", ("odometry", "map_filter"), "", None),
        (EKF, "ekf_filter_node", ("odometry", "ekf_filter_node"), "", None),
        (EKF, "ekf_node", ("odometry",), "", "/odometry"),
        (EKF, "ekf_node", ("",), "", "/ekf_filter_node"),
        (EKF, "ukf_node", ("",), "", None),
        (EKF, "map_saver", ("map_server",), "", None),
        (EKF, "map_savers", ("map_server",), "", "/map_server"),
        (EKF, "/r/joy_node", ("joy_node",), "", "/joy_node"),
        ("nav2_behaviors/behavior_server", "recoveries_server", ("",), "", "/behavior_server"),
    ],
)
def test_a_section_with_a_programs_own_name_is_meant_for_what_a_launch_renames(
    tmp_path, program, section, names, more, meant
):
    file, launch = tmp_path / "ekf.yaml", tmp_path / "app.launch.py"
    file.write_text(f"{section}: {{ros__parameters: {{odom0: /odom}}}}\n")
    package, program = program.split("/")
    named = [f"name={name!r}," if name else "" for name in names]
    nodes = "".join(
        PROGRAM.format(package=package, program=program, name=n, file=str(file), more=more)
        for n in named
    )
    head, _, _ = LAUNCH.partition("        Node(")
    launch.write_text(f"{head}{nodes}])\n")
    graph = scan_ros2_app([tmp_path], [(launch, {})], {}, ScanOptions(workers=1))
    assert without_node(graph) == ([(f"/{section.strip('/')}", (meant,))] if meant else [])


@pytest.mark.parametrize(("name", "found"), [("'x' + unknown()", ["/drive"]), ("unknown()", [])])
def test_a_node_whose_name_is_not_known_may_have_the_section(scanned, name, found):
    graph = scanned(f"/drive: {TWO}", more=f"rclpy.create_node({name})")
    assert [section for section, _ in without_node(graph)] == found


def test_a_node_whose_name_is_not_known_may_have_a_section_of_its_own(scanned, tmp_path):
    scanned(f"/drive: {TWO}", arm=())
    program, launch = tmp_path / "app/base.py", tmp_path / "app.launch.py"
    program.write_text(program.read_text().replace("'base'", "'x' + unknown()"))
    assert not without_node(scan_ros2_app([tmp_path], [(launch, {})], {}, ScanOptions(workers=1)))


def test_a_value_of_another_type_than_declared_is_a_fact(scanned, tmp_path):
    graph = scanned(of_base(max_vel=1, rate=2.0))
    (fact,) = (fact for fact in graph.wiring if fact.kind == "mistyped_parameter")
    assert (fact.subject, fact.value, fact.others) == ("/base", "max_vel", ("double", "integer"))
    assert [(Path(place.file).name, place.line) for place in fact.evidence] == [
        ("p.yaml", 3),
        ("app.launch.py", 5),
        ("base.py", 6),
    ]


@pytest.mark.parametrize(
    ("text", "is_malformed"),
    [
        ("base:\n  max_vel: 1.0\n", True),
        ("max_vel: 1.0\n", True),
        ("# nothing yet\n", False),
        ("/**:\n  ros__parameters:\n    max_vel: 1.0\n", False),
    ],
)
def test_a_file_of_values_without_ros__parameters_is_a_fact(scanned, tmp_path, text, is_malformed):
    graph = scanned(text)
    facts = [fact for fact in graph.wiring if fact.kind == "malformed_parameter_file"]
    assert [(fact.subject, fact.others) for fact in facts] == [
        (str(tmp_path / "p.yaml"), (node,)) for node in ("/base", "/arm") if is_malformed
    ]
    assert [place.line for fact in facts for place in fact.evidence] == [5, 6] * is_malformed


@pytest.mark.parametrize(
    ("name", "files", "is_missing"),
    [
        ("config/p.yaml", {}, True),
        ("config/p.yaml", {"config/p.yaml.in": ""}, False),
        ("config/p.yaml", {"CMakeLists.txt": "configure_file(p.in config/p.yaml)"}, False),
        ("../p.yaml", {}, False),
    ],
)
def test_a_parameter_file_that_its_package_lacks_is_missing(tmp_path, name, files, is_missing):
    package = tmp_path / "app"
    (package / "config").mkdir(parents=True)
    path = str((package / name).resolve())
    launch = package / "app.launch.py"
    launch.write_text(LAUNCH.replace("{given}", repr(path)))
    write(package, {"package.xml": MANIFEST, **files})
    graph = scan_ros2_app([tmp_path], [(launch, {})], {}, ScanOptions(workers=1))
    missing = [note for note in graph.unresolved if note.why.endswith("is no file")]
    assert [note.missing for note in missing] == [path if is_missing else ""]
    assert [place.line for note in missing for place in note.evidence] == [5, 6]
