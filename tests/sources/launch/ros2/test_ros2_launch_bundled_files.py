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


NAV2 = """
    IncludeLaunchDescription(
        PythonLaunchDescriptionSource(os.path.join(
            get_package_share_directory('nav2_bringup'), 'launch', '{}_launch.py')),
        launch_arguments={{'params_file': os.path.join(
            get_package_share_directory('pkg'), 'nav2.yaml'), **{}}}.items())
"""
SETTINGS = """
controller_server: {ros__parameters: {odom_topic: /wheels}}
slam_toolbox: {ros__parameters: {scan_topic: /front}}
"""


@pytest.fixture
def nav2(python, package):
    """Return a function that includes a launch file of Nav2, with the app's parameters."""
    (package / "nav2.yaml").write_text(SETTINGS)

    def app(name, distribution, **arguments):
        read = python(NAV2.format(name, arguments), environ={"ROS_DISTRO": distribution})
        return {start.name or start.program: start for start in read.starts}, whys(read)

    return app


FRAMES = (("/tf", "tf"), ("/tf_static", "tf_static"))
CHECKED = ("cmd_vel", "cmd_vel_nav")


@pytest.mark.parametrize(
    ("distribution", "count", "smoothed", "behaved"),
    [
        ("humble", 8, (CHECKED, ("cmd_vel_smoothed", "cmd_vel")), ()),
        ("jazzy", 11, (CHECKED,), (CHECKED,)),
        ("lyrical", 12, (CHECKED,), (CHECKED,)),
    ],
)
def test_nav2_navigates_without_its_folder(nav2, distribution, count, smoothed, behaved):
    starts, notes = nav2("navigation", distribution)
    assert len(starts) == count
    assert starts["velocity_smoother"].remaps == (*FRAMES, *smoothed)
    assert starts["behavior_server"].remaps == (*FRAMES, *behaved)
    assert values(starts["controller_server"])["odom_topic"] == "/wheels"
    managed = values(starts["lifecycle_manager_navigation"])["node_names"]
    assert {*managed, "lifecycle_manager_navigation"} == set(starts)
    assert not notes


@pytest.mark.parametrize(
    ("distribution", "arguments", "space"),
    [
        ("humble", {"namespace": "r1", "use_namespace": "True"}, "/r1"),
        ("humble", {"namespace": "r1"}, ""),
        ("kilted", {"namespace": "r1"}, "/r1"),
        ("lyrical", {"namespace": "r1"}, "/r1"),
    ],
)
def test_nav2_starts_in_its_namespace(nav2, distribution, arguments, space):
    starts, _ = nav2("bringup", distribution, **arguments)
    controller = starts["controller_server"]
    assert (controller.full_name, controller.container) == (
        f"{space}/controller_server",
        "/r1/nav2_container",
    )
    assert starts["nav2_container"].full_name == f"{space}/nav2_container"
    assert values(controller).get("odom_topic") == ("/wheels" if space else None)
    assert {"map_server", "amcl", "lifecycle_manager_localization"} <= set(starts)


def test_nav2_maps_with_the_parameters_of_its_file(nav2):
    starts, notes = nav2("bringup", "jazzy", slam="True", use_composition="False")
    assert starts["slam_toolbox"].program == "sync_slam_toolbox_node"
    assert values(starts["slam_toolbox"])["scan_topic"] == "/front"
    assert starts["slam_toolbox"].remaps[0] == ("/scan", "scan")
    assert "map_saver_server" in starts
    assert "amcl" not in starts
    assert not notes


def test_the_zones_of_nav2_are_noted(nav2):
    _, notes = nav2("bringup", "kilted")
    assert len(notes) == 2
    assert [zone in why for zone, why in zip(("keepout", "speed"), notes, strict=True)] == [
        True
    ] * 2


def test_nav2_without_parameters_has_those_that_are_not_here(python):
    app = python(INCLUDE.format("nav2_bringup", "navigation_launch.py"))
    known = {start.program: start.parameters_complete for start in app.starts}
    assert (known["planner_server"], known["lifecycle_manager"]) == (False, True)


@pytest.mark.parametrize(
    ("distribution", "arguments", "remaps"),
    [
        ("humble", {}, ()),
        ("humble", {"use_namespace": "True", "namespace": "r1"}, ("/map", "map")),
        ("kilted", {"namespace": "r1"}, ("/tf", "tf")),
    ],
)
def test_nav2_shows_itself_in_rviz(nav2, distribution, arguments, remaps):
    starts, _ = nav2("rviz", distribution, **arguments)
    assert [start.remaps[:1] for start in starts.values()] == [(remaps,) if remaps else ()]
    assert [start.namespace for start in starts.values()] == ["/r1" if remaps else "/"]


SLAM = """
    IncludeLaunchDescription(
        PathJoinSubstitution([FindPackageShare('slam_toolbox'), 'launch', '{}_launch.py']),
        launch_arguments={{'slam_params_file': '/slam.yaml'}}.items())
"""


@pytest.mark.parametrize(
    ("file", "program"),
    [
        ("online_async", "async_slam_toolbox_node"),
        ("online_sync", "sync_slam_toolbox_node"),
        ("localization", "localization_slam_toolbox_node"),
        ("offline", "sync_slam_toolbox_node"),
        ("lifelong", "lifelong_slam_toolbox_node"),
    ],
)
def test_slam_toolbox_starts_without_its_folder(python, file, program):
    app = python(SLAM.format(file))
    assert [(start.full_name, start.program) for start in app.starts] == [
        ("/slam_toolbox", program)
    ]


def test_foxglove_bridge_starts_without_its_folder(python):
    file = "[FindPackageShare('foxglove_bridge'), 'launch', 'foxglove_bridge_launch.xml']"
    app = python(f"IncludeLaunchDescription(PathJoinSubstitution({file}))")
    (bridge,) = app.starts
    assert values(bridge)["client_topic_whitelist"] == [".*"]
