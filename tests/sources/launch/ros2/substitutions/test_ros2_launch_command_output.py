"""What commands print that are not run: xacro's robots, and files."""

import pytest
from app_launch_values import values, whys

from rtron.vocabulary import UnknownValue

XACRO = """<?xml version="1.0"?>
<robot name="r" xmlns:xacro="http://ros.org/wiki/xacro">
  <xacro:arg name="prefix" default="p_"/>
  <xacro:include filename="$(find parts)/urdf/wheel.xacro"/>
  <xacro:wheel name="$(arg prefix)left"/>
</robot>
"""
WHEEL = """<robot xmlns:xacro="http://ros.org/wiki/xacro">
  <xacro:macro name="wheel" params="name"><link name="${name}_wheel"/></xacro:macro>
</robot>
"""


@pytest.fixture
def robot(package, tmp_path):
    """Write a robot with a part of an installed package; return its environment."""
    (package / "urdf").mkdir()
    (package / "urdf" / "robot.urdf.xacro").write_text(XACRO)
    urdf = tmp_path / "opt" / "share" / "parts" / "urdf"
    urdf.mkdir(parents=True)
    (urdf / "wheel.xacro").write_text(WHEEL)
    return {"AMENT_PREFIX_PATH": str(tmp_path / "opt")}


PATH = "PathJoinSubstitution([FindPackageShare('pkg'), 'urdf', 'robot.urdf.xacro'])"
PUBLISHER = "Node(package='robot_state_publisher', executable='robot_state_publisher', {})"


def described(app):
    return values(app.starts[0])["robot_description"]


@pytest.mark.parametrize(
    "command",
    [
        f"Command(['xacro ', {PATH}, ' prefix:=', LaunchConfiguration('prefix')])",
        f"Command([FindExecutable(name='xacro'), ' ', {PATH}, ' prefix:=a_'])",
        f"Command(['ros2 run xacro xacro ', {PATH}, ' prefix:=a_'])",
        f"ParameterValue(Command(['xacro ', {PATH}, ' prefix:=a_'], on_stderr='warn'), str)",
    ],
)
def test_a_robot_is_described_as_xacro_would(python, robot, command):
    declared = "DeclareLaunchArgument('prefix', default_value='a_'), "
    node = PUBLISHER.format(f"parameters=[{{'robot_description': {command}}}]")
    app = python(declared + node, environ=robot)
    assert '<link name="a_left_wheel"' in described(app)
    assert app.unresolved == ()


def test_the_same_in_xml_and_yaml(xml, read, robot):
    text = "$(command 'xacro $(find-pkg-share pkg)/urdf/robot.urdf.xacro prefix:=b_')"
    param = f'<param name="robot_description" type="str" value="{text}"/>'
    app = xml(f'<node pkg="p" exec="e">{param}</node>', robot)
    assert '<link name="b_left_wheel"' in described(app)
    param = f'{{name: robot_description, type: str, value: "{text}"}}'
    app = read(f"launch: [node: {{pkg: p, exec: e, param: [{param}]}}]", "yaml", robot)
    assert '<link name="b_left_wheel"' in described(app)
    assert app.unresolved == ()


def test_a_function_may_look_at_it(program, robot):
    text = f"""
def described(context):
    text = Command(['xacro ', {PATH}]).perform(context)
    return [Node(package='p', executable='e', parameters=[{{'robot_description': text}}])]

def generate_launch_description():
    return LaunchDescription([OpaqueFunction(function=described)])
"""
    app = program(text, environ=robot)
    assert '<link name="p_left_wheel"' in described(app)
    assert app.unresolved == ()


@pytest.mark.parametrize(
    ("call", "link"),
    [
        ("xacro.process_file(path).toxml()", "p_left"),
        ("xacro.process_file(path, mappings={'prefix': 'x_'}).toprettyxml(indent='  ')", "x_left"),
        ("xacro.process(path, mappings={'prefix': str(3)})", "3left"),
    ],
)
def test_the_module_xacro(python, robot, call, link):
    before = f"""
import xacro
path = os.path.join(get_package_share_directory('pkg'), 'urdf', 'robot.urdf.xacro')
robot = {call}
"""
    app = python(PUBLISHER.format("parameters=[{'robot_description': robot}]"), before, robot)
    assert f'<link name="{link}_wheel"' in described(app)
    assert app.unresolved == ()


def test_what_is_replaced_in_a_long_description(python, package):
    meshes = "<mesh filename='package://pkg/a.stl'/>" * 300
    (package / "robot.urdf").write_text(f"<robot name='r'>{meshes}</robot>")
    before = """
with open(os.path.join(get_package_share_directory('pkg'), 'robot.urdf')) as urdf:
    robot = urdf.read().replace('package://', f'file://{"/opt"}/')
"""
    app = python(PUBLISHER.format("parameters=[{'robot_description': robot}]"), before)
    assert described(app).count("'file:///opt/pkg/a.stl'") == 300
    assert app.unresolved == ()


def test_what_is_replaced_again_and_again_is_bounded(python, package):
    (package / "robot.urdf").write_text("<robot name='r'/>" * 2**15)
    before = """
robot = open(os.path.join(get_package_share_directory('pkg'), 'robot.urdf')).read()
kept = []
for i in range(100):
    for j in range(100):
        kept.append(robot.replace('r', 's'))
"""
    app = python("Node(package='p', executable='e')", before)
    assert "too large to be run whole" in whys(app)


@pytest.mark.parametrize(
    ("call", "why"),
    [
        ("xacro.process_file('/no.xacro').toxml()", "/no.xacro: No such file or directory"),
        ("xacro.process_file('no.xacro').toxml()", "the folder of the launch is not known"),
        ("xacro.process(open('/x').read())", ""),
        ("xacro.process('/x', mappings={'a': open('/x').read()})", ""),
        ("xacro.process('/x', mappings=open('/x'))", ""),
    ],
)
def test_what_the_module_xacro_does_not_know(python, call, why):
    app = python(PUBLISHER.format(f"parameters=[{{'robot_description': {call}}}]"), "import xacro")
    assert isinstance(described(app), UnknownValue)
    assert not why or any(why in one for one in whys(app))


def test_a_description_longer_than_other_texts(python, package):
    links = "".join(f'<link name="link_{number}"/>' for number in range(9_000))
    (package / "big.xacro").write_text(f"<robot name='r'>{links}</robot>")
    command = "Command(['xacro ', FindPackageShare('pkg'), '/big.xacro'])"
    app = python(
        f"DeclareLaunchArgument('d', default_value={command}),"
        "Node(package='p', executable='e',"
        " parameters=[{'robot_description': ParameterValue(LaunchConfiguration('d'), str)}])"
    )
    assert '<link name="link_8999"' in described(app)
    assert app.unresolved == ()
    macro = f"<xacro:macro name='m' params=''>{links[: links.index('link_400') - 12]}</xacro:macro>"
    text = f"<robot xmlns:xacro='x'>{macro}{'<xacro:m/>' * 200}</robot>"
    (package / "big.xacro").write_text(text)
    app = python(f"Node(package='p', executable='e', name={command})")
    assert whys(app)[0].endswith("more than 1048576 characters are printed")


def test_a_file_is_printed(python, package):
    (package / "r.urdf").write_text("<robot name='plain'/>")
    command = "Command(['cat ', FindPackageShare('pkg'), '/r.urdf'])"
    app = python(f"Node(package='p', executable='e', parameters=[{{'d': {command}}}])")
    assert values(app.starts[0]) == {"d": "<robot name='plain'/>"}
    assert app.unresolved == ()


@pytest.mark.parametrize(
    ("command", "why"),
    [
        ("'rm -r /'", "$(command rm -r /) is not run"),
        ("'xacro /no/robot.xacro'", "/no/robot.xacro: No such file"),
        ("'xacro robot.xacro'", "robot.xacro: the folder of the launch is not known"),
        ("'cat /no/file'", "/no/file: is no file"),
        ("'xacro -o /tmp/x /no/robot.xacro'", "$(command xacro -o /tmp/x /no/robot.xacro) is not"),
        ("['xacro /r.xacro n:=', LaunchConfiguration('z')]", "argument 'z' is not given"),
        ("['which ', LaunchConfiguration('z')]", "$(command which {z}) is not run"),
    ],
)
def test_what_is_not_known_is_noted(python, command, why):
    app = python(f"Node(package='p', executable='e', parameters=[{{'d': Command({command})}}])")
    assert isinstance(values(app.starts[0])["d"], UnknownValue)
    assert any(why in one for one in whys(app)), whys(app)
    place = next(note for note in app.unresolved if why in note.why).evidence[0]
    assert (place.file.endswith("app.launch.py"), place.line > 0) == (True, True)


def test_what_xacro_does_not_resolve_is_noted_where_it_stands(python, package):
    path = package / "r.xacro"
    text = "<robot xmlns:xacro='http://ros.org/wiki/xacro'>\n<link name='${open(1)}'/></robot>"
    path.write_text(text)
    command = "Command(['xacro ', FindPackageShare('pkg'), '/r.xacro'])"
    app = python(f"Node(package='p', executable='e', parameters=[{{'d': {command}}}])")
    assert "<robot" in values(app.starts[0])["d"]
    assert [(one.evidence[0].file, one.evidence[0].line) for one in app.unresolved] == [
        (str(path), 2)
    ]


@pytest.mark.parametrize(
    "body",
    [
        "<xacro:macro name='m' params=''><xacro:m/><xacro:m/></xacro:macro><xacro:m/>",
        "<xacro:include filename='r.xacro'/><xacro:include filename='r.xacro'/>",
        "<a>" * 3_000,
        "<!DOCTYPE r [<!ENTITY a 'b'>]>",
    ],
)
def test_hostile_robots_end(python, package, body):
    text = f"<robot xmlns:xacro='http://ros.org/wiki/xacro'>{body}</robot>"
    (package / "r.xacro").write_text(text)
    command = "Command(['xacro ', FindPackageShare('pkg'), '/r.xacro a:=', '{}'])"
    names = ",".join(f"Node(package='p', executable='e', name={command})" for _ in range(3))
    app = python(names)
    assert len(app.starts) == 3
    assert app.unresolved


def test_no_more_robots_than_any_app_has(python, package):
    (package / "r.xacro").write_text("<robot/>")
    command = "Command(['xacro ', FindPackageShare('pkg'), '/r.xacro a:={}'])"
    nodes = (
        f"Node(package='p', executable='e', parameters=[{{'d': {command.format(number)}}}])"
        for number in range(34)
    )
    app = python(",".join(nodes))
    assert "<robot" in values(app.starts[31])["d"]
    assert isinstance(values(app.starts[33])["d"], UnknownValue)
    assert "more than 32 robots are described" in whys(app)
