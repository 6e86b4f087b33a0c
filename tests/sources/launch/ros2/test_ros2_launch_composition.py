"""A robot whose nodes start alone or composed: only the branch that is taken starts."""

import pytest
from app_launch_values import names, values

BRINGUP = """
def generate_launch_description():
    folder = get_package_share_directory('pkg')
    namespace = LaunchConfiguration('namespace')
    composed = LaunchConfiguration('composed')
    params = LaunchConfiguration('params')
    shared = [('/tf', 'tf')]
    configured = ParameterFile(
        RewrittenYaml(source_file=params, root_key=namespace, param_rewrites={}), allow_substs=True)
    alone = GroupAction(
        condition=IfCondition(PythonExpression(['not ', composed])),
        actions=[
            SetParameter('use_sim_time', LaunchConfiguration('sim')),
            Node(package='c', executable='controller', name='controller', parameters=[configured],
                 remappings=shared + [('cmd_vel', 'cmd_vel_raw')]),
            Node(package='s', executable='smoother', name='smoother', parameters=[configured],
                 remappings=shared + [('cmd_vel', 'cmd_vel_raw')])])
    together = GroupAction(
        condition=IfCondition(composed),
        actions=[
            SetParameter('use_sim_time', LaunchConfiguration('sim')),
            LoadComposableNodes(
                target_container=(namespace, '/', 'box'),
                composable_node_descriptions=[
                    ComposableNode(package='c', plugin='c::Controller', name='controller',
                                   parameters=[configured],
                                   remappings=shared + [('cmd_vel', 'cmd_vel_raw')]),
                    ComposableNode(package='s', plugin='s::Smoother', name='smoother',
                                   parameters=[configured],
                                   remappings=shared + [('cmd_vel', 'cmd_vel_raw')])])])
    ld = LaunchDescription()
    ld.add_action(DeclareLaunchArgument('namespace', default_value=''))
    ld.add_action(DeclareLaunchArgument('sim', default_value='true'))
    ld.add_action(DeclareLaunchArgument('composed', default_value='True'))
    ld.add_action(DeclareLaunchArgument(
        'params', default_value=os.path.join(folder, 'params.yaml')))
    ld.add_action(Node(condition=IfCondition(composed), name='box', namespace=namespace,
                       package='rclcpp_components', executable='component_container'))
    ld.add_action(GroupAction([PushRosNamespace(namespace), alone, together]))
    return ld
"""
PARAMS = """
controller: {ros__parameters: {frequency: 20.0, sim: $(var sim)}}
smoother: {ros__parameters: {out: cmd_vel}}
"""


@pytest.fixture
def bringup(program, package):
    """Return a function that reads the launch file for some arguments."""
    (package / "params.yaml").write_text(PARAMS)
    return lambda **arguments: program(BRINGUP, **arguments)


def test_the_nodes_are_composed_by_default(bringup):
    app = bringup()
    assert names(app) == ["/box", "/controller", "/smoother"]
    assert [start.container for start in app.starts] == ["", "/box", "/box"]
    assert [start.program for start in app.starts[1:]] == ["c::Controller", "s::Smoother"]
    assert not any(start.is_uncertain for start in app.starts)
    assert app.unresolved == ()


def test_the_nodes_alone_in_a_namespace(bringup):
    app = bringup(composed="False", namespace="r1")
    assert names(app) == ["/r1/controller", "/r1/smoother"]
    assert [start.program for start in app.starts] == ["controller", "smoother"]


@pytest.mark.parametrize("composed", ["True", "False"])
@pytest.mark.parametrize("namespace", ["", "r1"])
def test_remaps_and_parameters_are_the_same_in_both(bringup, composed, namespace):
    controller, smoother = bringup(composed=composed, namespace=namespace).starts[-2:]
    assert controller.remaps == smoother.remaps == (("/tf", "tf"), ("cmd_vel", "cmd_vel_raw"))
    assert values(controller) == {"use_sim_time": True, "frequency": 20.0, "sim": True}
    assert values(smoother) == {"use_sim_time": True, "out": "cmd_vel"}


def test_it_is_not_known_whether_the_nodes_are_composed(bringup, program):
    app = program(BRINGUP.replace("default_value='True'", "default_value=Command('which gz')"))
    assert len(app.starts) == 5
    assert all(start.is_uncertain for start in app.starts)
