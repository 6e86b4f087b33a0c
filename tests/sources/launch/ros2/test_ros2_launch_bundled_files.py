"""ros_gz's actions and launch files start what they include, also where its folder is not there."""

import pytest
from app_launch_values import names, values, whys

XML = (
    "<ros_gz_bridge bridge_name='gate' namespace='r' config_file='/b.yaml' {}/>"
    "<gz_server world_sdf_file='w.sdf' {}/>"
    "<gz_spawn_model file='/r.sdf' entity_name='robo'/>"
)
PYTHON = """
from ros_gz_bridge.actions import RosGzBridge
from ros_gz_sim.actions import GzServer, GzSpawnModel
"""
ACTIONS = """
    RosGzBridge(bridge_name='gate', namespace='r', config_file='/b.yaml', {}),
    GzServer(world_sdf_file='w.sdf', {}),
    GzSpawnModel(file='/r.sdf', entity_name='robo'),
"""
INCLUDE = """
    IncludeLaunchDescription(
        PathJoinSubstitution([FindPackageShare('{}'), 'launch', '{}']),
        launch_arguments={{'bridge_name': 'gate', 'config_file': '/b.yaml',
                          'topic': 'robot_description'}}.items())
"""


def told(start):
    """Return the parameters that say something."""
    return {name: value for name, value in values(start).items() if value}


def both(python, xml, **given):
    """Read the same actions in both formats."""
    in_python = "".join(f"{name}='{value}', " for name, value in given.items())
    in_xml = " ".join(f"{name}='{value}'" for name, value in given.items())
    yield python(ACTIONS.format(in_python, in_python), PYTHON)
    yield xml(XML.format(in_xml, in_xml))


def test_alone_they_are_programs(python, xml):
    for app in both(python, xml):
        kinds = [(start.package, start.program, start.container) for start in app.starts]
        assert kinds == [
            ("ros_gz_bridge", "bridge_node", ""),
            ("ros_gz_sim", "gzserver", ""),
            ("ros_gz_sim", "create", ""),
        ]
        assert names(app)[0] == "/r/gate"
        assert [told(start) for start in app.starts] == [
            {"config_file": "/b.yaml"},
            {"world_sdf_file": "w.sdf"},
            {"file": "/r.sdf", "name": "robo"},
        ]
        assert [start.evidence.line > 0 for start in app.starts] == [True] * 3
        assert not app.unresolved


def test_composed_they_are_loaded_into_a_container_of_others(python, xml):
    for app in both(python, xml, use_composition="True", container_name="box"):
        loaded = [(start.program, start.container) for start in app.starts]
        assert loaded[:2] == [
            ("ros_gz_bridge::RosGzBridge", "/box"),
            ("ros_gz_sim::GzServer", "/box"),
        ]


def test_composed_on_their_own_they_bring_a_container(python, xml):
    for app in both(python, xml, use_composition="true", create_own_container="true"):
        started = [start.program for start in app.starts]
        alone = ["component_container", "ros_gz_bridge::RosGzBridge"]
        assert started[:2] == alone
        assert names(app)[0] == "/ros_gz_container"


LEFT = """
    RosGzBridge(bridge_name='one', config_file='/b.yaml', namespace='a', use_composition='True'),
    RosGzBridge(bridge_name='two', config_file='/b.yaml'),
    GzServer(world_sdf_file='w.sdf'),
    GzSpawnModel(file='/one.sdf'),
    GzSpawnModel(topic='robot_description'),
"""


def test_one_action_leaves_nothing_to_the_next(python):
    one, two, *others = python(LEFT, PYTHON).starts
    assert (one.full_name, one.container) == ("/a/one", "/ros_gz_container")
    assert (two.full_name, two.container) == ("/two", "")
    assert [(start.program, told(start)) for start in others] == [
        ("gzserver", {"world_sdf_file": "w.sdf"}),
        ("create", {"file": "/one.sdf"}),
        ("create", {"topic": "robot_description"}),
    ]


@pytest.mark.parametrize("file", ["ros_gz_sim.launch.py", "ros_gz_spawn_model.launch.py"])
def test_files_that_include_a_bridge_bring_it(python, file):
    app = python(INCLUDE.format("ros_gz_sim", file))
    (bridge,) = [start for start in app.starts if start.name == "gate"]
    assert told(bridge) == {"config_file": "/b.yaml"}


@pytest.mark.parametrize(
    ("owner", "file", "program", "parameters"),
    [
        ("ros_gz_bridge", "ros_gz_bridge.launch.py", "bridge_node", {"config_file": "/b.yaml"}),
        ("ros_gz_bridge", "ros_gz_bridge.launch", "bridge_node", {"config_file": "/b.yaml"}),
        ("ros_gz_sim", "gz_spawn_model.launch.py", "create", {"topic": "robot_description"}),
        ("ros_gz_sim", "gz_server.launch.py", "gzserver", {}),
    ],
)
def test_their_launch_files_are_known_without_their_folder(
    python, owner, file, program, parameters
):
    app = python(INCLUDE.format(owner, file))
    assert [(start.program, told(start)) for start in app.starts] == [(program, parameters)]


@pytest.mark.parametrize(
    ("owner", "file"), [("ros_gz_sim", "other.launch.py"), ("mine", "ros_gz_bridge.launch.py")]
)
def test_others_without_their_folder_are_noted(python, owner, file):
    app = python(INCLUDE.format(owner, file))
    assert not app.starts
    assert any(file in why for why in whys(app))


def test_gazebo_alone_is_no_node(python):
    app = python(INCLUDE.format("ros_gz_sim", "gz_sim.launch.py"))
    assert (app.starts, app.unresolved) == ((), ())
