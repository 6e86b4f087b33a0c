"""Python launch files that are programs: functions, loops, files, and what they cannot decide."""

import pytest
from app_launch_values import names, values, whys

NODE = "Node(package='p', executable='e', name={})"


def test_a_function_gets_a_context_in_which_texts_have_values(program):
    app = program("""
def setup(context, prefix, *, ns):
    robot = LaunchConfiguration('robot')
    names = [robot.perform(context), context.launch_configurations['robot'],
             context.perform_substitution(robot), context.launch_configurations.get('no', 'none'),
             perform_substitutions(context, [robot, '_x'])]
    return [Node(executable='e', name=prefix + name, namespace=ns) for name in names]
from launch.utilities import perform_substitutions
def generate_launch_description():
    return LaunchDescription([DeclareLaunchArgument('robot', default_value='tb3'),
        OpaqueFunction(function=setup, args=['p_'], kwargs={'ns': 'ns'})])
""")
    assert names(app) == [f"/ns/p_{name}" for name in ("tb3", "tb3", "tb3", "none", "tb3_x")]
    assert app.unresolved == ()


def test_a_function_sees_what_was_set_before_it_and_sets_what_comes_after(program):
    app = program(f"""
def setup(context):
    found = context.launch_configurations['count']
    context.launch_configurations['count'] = str(int(found) + 1)
    return GroupAction([{NODE.format("'n' + found")}])
def generate_launch_description():
    return LaunchDescription([SetLaunchConfiguration('count', '1'),
        OpaqueFunction(function=setup), OpaqueFunction(function=setup),
        {NODE.format("['m', LaunchConfiguration('count')]")}])
""")
    assert names(app) == ["/n1", "/n2", "/m3"]


def test_a_function_sees_the_parameters_and_remaps_for_all_nodes(program):
    app = program("""
def setup(context):
    shared = dict(context.launch_configurations.get('global_params', []))
    remaps = context.launch_configurations.get('ros_remaps', [])
    length = shared['front'] + shared['rear']
    return [Node(executable='e', name='n' + str(len(remaps)), parameters=[{'length': length}])]
def generate_launch_description():
    return LaunchDescription([SetParameter('front', 1.5), SetParameter('rear', 2.0),
        SetRemap('a', 'b'), OpaqueFunction(function=setup)])
""")
    assert names(app) == ["/n1"]
    assert values(app.starts[0])["length"] == 3.5
    assert app.unresolved == ()


def test_a_function_decides_by_what_it_is_given(program):
    text = f"""
def setup(context):
    if LaunchConfiguration('sim').perform(context).lower() == 'true':
        return [{NODE.format("'sim'")}]
    return [{NODE.format("'real'")}]
def generate_launch_description():
    return LaunchDescription([DeclareLaunchArgument('sim'), OpaqueFunction(function=setup)])
"""
    assert names(program(text, sim="True")) == ["/sim"]
    assert names(program(text, sim="no")) == ["/real"]
    app = program(text)
    assert sorted(names(app)) == ["/real", "/sim"]
    assert all(start.is_uncertain for start in app.starts)
    assert any("both sides are read" in why for why in whys(app))


def test_loops_over_known_lists_and_dicts(program):
    app = program(f"""
ROBOTS = [{{'name': 'a', 'x': 1.0}}, {{'name': 'b', 'x': 2.0}}]
def generate_launch_description():
    ld = LaunchDescription()
    for number, robot in enumerate(ROBOTS):
        ld.add_action(Node(executable='e', name=f"{{robot['name']}}_{{number}}",
                           parameters=[{{'x': robot['x']}}]))
    for key, value in {{'c': 'd'}}.items():
        ld.add_entity({NODE.format("key + value")})
    return ld
""")
    assert names(app) == ["/a_0", "/b_1", "/cd"]
    assert values(app.starts[1]) == {"x": 2.0}


def test_concatenated_lists_and_functions_that_make_actions(program):
    app = program("""
BASE = [('/tf', 'tf')]
def made(name, more=(), **kwargs):
    return Node(executable='e', name=name, remappings=BASE + list(more), **kwargs)
def generate_launch_description():
    first = [made('a')]
    first += [made('b', more=[('x', 'y')], namespace='ns')]
    return LaunchDescription(first + [made('c')])
""")
    assert names(app) == ["/a", "/ns/b", "/c"]
    assert app.starts[1].remaps == (("/tf", "tf"), ("x", "y"))
    assert app.starts[2].remaps == (("/tf", "tf"),)


def test_a_file_that_the_launch_file_reads(program, package):
    (package / "robots.yaml").write_text("robots: [{name: a, topics: {out: /a}}, {name: b}]")
    app = program("""
def generate_launch_description():
    path = Path(get_package_share_directory('pkg')) / 'robots.yaml'
    with open(path) as file:
        robots = yaml.safe_load(file)['robots']
    nodes = [Node(executable='e', name=robot['name'],
                  remappings=list(robot.get('topics', {}).items())) for robot in robots]
    return LaunchDescription(nodes)
""")
    assert names(app) == ["/a", "/b"]
    assert app.starts[0].remaps == (("out", "/a"),)


def test_the_environment_and_the_existence_of_files(program, package):
    text = f"""
def generate_launch_description():
    nodes = [{NODE.format("os.environ.get('MODEL', 'burger')")}]
    if os.path.exists(os.path.join(get_package_share_directory('pkg'), 'package.xml')):
        nodes.append({NODE.format("'there'")})
    if os.environ.get('ROS_DISTRO') == 'humble':
        nodes.append({NODE.format("'humble'")})
    return LaunchDescription(nodes)
"""
    environ = {"MODEL": "waffle", "ROS_DISTRO": "humble"}
    assert names(program(text, environ=environ)) == ["/waffle", "/there", "/humble"]
    assert names(program(text)) == ["/burger", "/there"]


def test_a_list_that_is_not_known(program):
    app = program(f"""
import rclpy
def generate_launch_description():
    return LaunchDescription([{NODE.format("name")} for name in rclpy.robots()])
""")
    assert names(app) == ["/{name}"]
    assert any("what it starts is not known" in why for why in whys(app))


def test_loops_of_launch_itself(program):
    app = program(f"""
def numbered(i):
    return [{NODE.format("'n' + str(i)")}]
def each(name, ns='x'):
    return [Node(executable='e', name=name, namespace=ns)]
def generate_launch_description():
    robots = "{{name: a}};{{name: b, ns: c}}"
    return LaunchDescription([DeclareLaunchArgument('robots', default_value=robots),
        ForLoop(LaunchConfiguration('n', default='2'), function=numbered),
        ForEach(LaunchConfiguration('robots'), function=each)])
""")
    assert names(app) == ["/n0", "/n1", "/x/a", "/c/b"]


def test_how_often_a_loop_runs_may_not_be_known(program):
    app = program(f"""
def generate_launch_description():
    made = lambda i: [{NODE.format("['n', str(i)]")}]
    return LaunchDescription([ForLoop(LaunchConfiguration('n'), made)])
""")
    assert names(app) == ["/n{i}"]
    assert any("how often" in why for why in whys(app))


def test_a_node_class_of_the_launch_file_itself(program):
    app = program("""
class Driver(Node):
    def __init__(self, name):
        super().__init__(package='p', executable='driver', name=name, namespace='drivers')
def generate_launch_description():
    return LaunchDescription([Driver('left')])
""")
    assert [(one.full_name, one.program) for one in app.starts] == [("/drivers/left", "driver")]


HELPER = """
import importlib.util
def declared(path):
    spec = importlib.util.spec_from_file_location('other', path)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    found = module.generate_launch_description().get_launch_arguments()
    return [(each.name, each.choices) for each in found]
def include(config):
    from ament_index_python import get_package_share_path, get_search_paths
    installed = [path.split('/')[-1] for path in get_search_paths()]
    actions = []
    for name, given in config.items():
        package = name if name in installed else f'my_{name}'
        path = str(get_package_share_path(package) / 'launch' / f'{name}.launch.py')
        if not os.path.exists(path):
            raise ValueError(path)
        for key in given:
            if key not in [known for known, _ in declared(path)]:
                raise ValueError(key)
        source = PythonLaunchDescriptionSource(path)
        actions.append(IncludeLaunchDescription(source, launch_arguments=list(given.items())))
    return LaunchDescription(actions)
"""


def test_a_helper_includes_the_launch_files_of_packages_by_their_names(program, package):
    (package / "launch" / "pkg.launch.py").write_text("""
from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument
from launch.substitutions import LaunchConfiguration
from launch_ros.actions import Node
def generate_launch_description():
    name = LaunchConfiguration('name')
    return LaunchDescription([DeclareLaunchArgument('name'),
                              Node(package='p', executable='e', name=name)])
""")
    text = "def generate_launch_description():\n    return include({'pkg': {'name': 'a'}})\n"
    app = program(HELPER + text)
    assert names(app) == ["/a"]
    assert app.unresolved == ()


def test_a_helper_that_loads_what_is_not_here_is_noted_with_readable_names(program):
    text = "def generate_launch_description():\n    return include({'other': {'name': 'a'}})\n"
    assert "import of {find-pkg-share my_other}/launch/other.launch.py" in {
        note.what for note in program(HELPER + text).unresolved
    }


def test_one_of_two_nodes(program):
    app = program(f"""
def generate_launch_description():
    one, other = {NODE.format("'a'")}, {NODE.format("'b'")}
    return LaunchDescription([one if os.path.exists('/no/such') else other, {NODE.format("'c'")}])
""")
    assert names(app) == ["/a", "/b", "/c"]
    assert [start.is_uncertain for start in app.starts] == [True, True, False]


def test_a_context_that_the_launch_file_makes_itself(program, package):
    (package / "p.yaml").write_text("/**: {ros__parameters: {a: x}}")
    app = program("""
from launch import LaunchContext
def generate_launch_description():
    source = os.path.join(get_package_share_directory('pkg'), 'p.yaml')
    file = RewrittenYaml(source, {'a': 'y'}).perform(LaunchContext())
    return LaunchDescription([Node(executable='e', name='n', parameters=[file])])
""")
    assert values(app.starts[0]) == {"a": "y"}


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("x = 1", "has no function"),
        ("raise RuntimeError('no')\ndef generate_launch_description(): pass", ""),
        ("def generate_launch_description():\n    return generate_launch_description()", "itself"),
        ("def generate_launch_description():\n    while True: pass", ""),
        ("import sys\nsys.exit(1)\ndef generate_launch_description(): pass", "ends it before"),
        ("def generate_launch_description(:", "has no function"),
        ("def generate_launch_description():\n    actions = [Node(", "returns nothing"),
        (
            "def generate_launch_description():\n    return LaunchDescription(["
            + "[" * 90
            + "]" * 90
            + "])",
            "",
        ),
    ],
)
def test_a_program_that_describes_nothing(program, text, why):
    app = program(text)
    assert app.starts == ()
    assert not why or any(why in one for one in whys(app))


def test_a_program_that_would_run_for_ever_ends(program):
    app = program("""
def generate_launch_description():
    text = 'x'
    nodes = []
    for a in range(1000):
        for b in range(1000):
            text += 'y'
            nodes.append(Node(executable='e', name='n'))
    return LaunchDescription(nodes)
""")
    assert 0 < len(app.starts) <= 1024
    assert "is not known here: what it starts is not known" in whys(app)


def test_nothing_is_run(program, tmp_path):
    mark = tmp_path / "mark"
    app = program(f"""
import subprocess
open({str(mark)!r}, 'w').write('x')
os.system('touch {mark}')
subprocess.run(['touch', {str(mark)!r}])
eval("open({str(mark)!r}, 'w')")
exec("open({str(mark)!r}, 'w')")
def setup(context):
    os.system('touch {mark}')
    return []
def generate_launch_description():
    opened = PythonExpression("open('{mark}', 'w')")
    return LaunchDescription([
        OpaqueFunction(function=setup), ExecuteProcess(cmd=['touch', {str(mark)!r}]),
        Node(package=Command(['touch {mark}']), executable=opened)])
""")
    assert len(app.starts) == 2
    assert not mark.exists()


@pytest.mark.parametrize("given", ["args=[ld]", "kwargs={'ld': ld}"])
def test_a_function_adds_to_the_description_that_it_gets(program, given):
    app = program(f"""
def setup(context, ld):
    ld.add_action({NODE.format("LaunchConfiguration('robot')")})
    return [{NODE.format("'returned'")}]
def generate_launch_description():
    ld = LaunchDescription([DeclareLaunchArgument('robot', default_value='tb3')])
    ld.add_action(OpaqueFunction(function=setup, {given}))
    ld.add_action({NODE.format("'behind'")})
    return ld
""")
    assert names(app) == ["/returned", "/behind", "/tb3"]
    assert app.unresolved == ()


def test_a_function_within_another_adds_to_the_description_around_it_once_a_call(program):
    app = program("""
def generate_launch_description():
    ld = LaunchDescription()
    def setup(context, name):
        ld.add_action(Node(package='p', executable='e', name=name))
    for name in ('a', 'b'):
        ld.add_action(OpaqueFunction(function=setup, args=[name]))
    return ld
""")
    assert names(app) == ["/a", "/b"]


def test_what_a_function_adds_starts_where_the_description_ends(program):
    app = program(f"""
def inner(context, ld):
    ld.add_action({NODE.format("'last'")})
def setup(context, ld):
    ld.add_action({NODE.format("'added'")})
    ld.add_action(OpaqueFunction(function=inner, args=[ld]))
def late(event, context):
    described.add_action({NODE.format("'never'")})
def generate_launch_description():
    global described
    described = LaunchDescription()
    described.add_action(GroupAction([PushRosNamespace('group'),
        OpaqueFunction(function=setup, args=[described])]))
    described.add_action(RegisterEventHandler(OnProcessExit(on_exit=late)))
    described.add_action(PushRosNamespace('robot'))
    return described
""")
    assert names(app) == ["/robot/added", "/robot/last"]


@pytest.mark.parametrize("scope", ["{}", "GroupAction([{}], scoped=False)", "[{}]"])
def test_what_starts_by_a_value_that_a_function_may_set_is_read(program, scope):
    app = program(f"""
def choose(context):
    if LaunchConfiguration('auto').perform(context) != 'true':
        return []
    if port_in_use():
        return {scope.format("SetLaunchConfiguration('driver', 'false')")}
    return [LogInfo(msg='starts')]
def generate_launch_description():
    driver = IfCondition(LaunchConfiguration('driver'))
    return LaunchDescription([DeclareLaunchArgument('auto', default_value='true'),
        DeclareLaunchArgument('driver', default_value='true'), OpaqueFunction(function=choose),
        Node(package='p', executable='e', name='n', condition=driver), {NODE.format("'m'")}])
""")
    assert [(start.full_name, start.is_uncertain) for start in app.starts] == [
        ("/n", True), ("/m", False)]  # fmt: skip
    assert any("(driver), it is read as if it did; what is given for auto may" in why
               for why in whys(app))  # fmt: skip


def test_an_undecided_include_leaves_what_it_declares_and_may_change_what_was_set(program, package):
    text = "<launch><arg name='new' default='a'/><let name='old' value='b'/></launch>"
    (package / "launch/inner.launch.xml").write_text(text)
    app = program(f"""
def generate_launch_description():
    found = os.path.join(get_package_share_directory('pkg'), 'launch', 'inner.launch.xml')
    return LaunchDescription([SetLaunchConfiguration('old', 'c'),
        IncludeLaunchDescription(found, condition=IfCondition(EnvironmentVariable('X'))),
        {NODE.format("[LaunchConfiguration('new'), '_', LaunchConfiguration('old')]")}])
""")
    assert names(app) == ["/a_{old}"]
