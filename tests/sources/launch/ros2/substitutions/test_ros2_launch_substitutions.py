"""Substitutions, in Python and in the words of XML: one name for each, evaluated the same."""

import pytest
from app_launch_values import names, whys

ENVIRON = {"WHO": "me"}
DECLARED = {"a": "x", "yes": "true", "no": "0", "n": "3"}


@pytest.mark.parametrize(
    ("python_text", "xml_text", "value"),
    [
        ("LaunchConfiguration('a')", "$(var a)", "x"),
        ("LaunchConfiguration('z', default=['d', 'e'])", "$(var z de)", "de"),
        ("[LaunchConfiguration('a'), '_', TextSubstitution(text='y')]", "$(var a)_y", "x_y"),
        ("EnvironmentVariable('WHO')", "$(env WHO)", "me"),
        ("EnvironmentVariable('NO', default_value='d')", "$(env NO d)", "d"),
        ("PathJoinSubstitution(['a', [LaunchConfiguration('a'), 'b'], 'c'])", None, "a/xb/c"),
        ("StringJoinSubstitution([LaunchConfiguration('a'), 'b'], delimiter='-')", None, "x-b"),
        ("PythonExpression(['\"', LaunchConfiguration('a'), '\" + \"b\"'])",
         "$(eval '\\'$(var a)\\' + \\'b\\'')", "xb"),
        ("PythonExpression('2 + 3')", "$(eval 2+3)", "5"),
        ("IfElseSubstitution(LaunchConfiguration('yes'), 'b', 'c')", "$(if $(var yes) b c)", "b"),
        ("IfElseSubstitution(LaunchConfiguration('no'), 'b', 'c')", "$(if $(var no) b c)", "c"),
        ("NotSubstitution(LaunchConfiguration('yes'))", "$(not $(var yes))", "false"),
        ("AndSubstitution('true', LaunchConfiguration('no'))", "$(and true $(var no))", "false"),
        ("OrSubstitution('false', LaunchConfiguration('yes'))", "$(or false $(var yes))", "true"),
        ("AnySubstitution('0', '0', '1')", "$(any 0 0 1)", "true"),
        ("AllSubstitution('1', '1', '0')", "$(all 1 1 0)", "false"),
        ("EqualsSubstitution(LaunchConfiguration('n'), 3.0)", "$(equals $(var n) 3.0)", "true"),
        ("EqualsSubstitution(LaunchConfiguration('yes'), True)", "$(equals $(var yes) 1)", "true"),
        ("NotEqualsSubstitution('a', 'b')", "$(not-equals a b)", "true"),
        ("FindExecutable(name='ls')", "$(find-exec ls)", "ls"),
        ("LaunchConfigAsBool('yes')", None, "True"),
    ],
)  # fmt: skip
def test_a_substitution_that_has_a_value(python, xml, python_text, xml_text, value):
    declared = "".join(
        f"DeclareLaunchArgument('{k}', default_value='{v}'), " for k, v in DECLARED.items()
    )
    app = python(f"{declared} Node(package={python_text}, executable='e')", environ=ENVIRON)
    assert app.starts[0].package == value
    assert app.unresolved == ()
    if xml_text is not None:
        declared = "".join(f'<arg name="{k}" default="{v}"/>' for k, v in DECLARED.items())
        app = xml(f'{declared}<node pkg="{xml_text}" exec="e"/>', environ=ENVIRON)
        assert app.starts[0].package == value
        assert app.unresolved == ()


def test_what_is_imported_from_the_module_that_defines_it(python):
    imports = """from launch.actions.declare_launch_argument import DeclareLaunchArgument
from launch.substitutions.launch_configuration import LaunchConfiguration
import launch_ros.actions.node
Node = launch_ros.actions.node.Node"""
    described = "DeclareLaunchArgument('a', default_value='x'), "
    app = python(f"{described} Node(package=LaunchConfiguration('a'), executable='e')", imports)
    assert app.starts[0].package == "x"
    assert app.unresolved == ()


def test_where_packages_and_files_lie(python, xml, package):
    share = str(package)
    for text in (
        "FindPackageShare('pkg')",
        "FindPackageShare(package=['p', 'kg']).find('pkg')",
        "get_package_share_directory('pkg')",
        "str((Path(get_package_share_directory('pkg')) / 'launch' / 'x.py').parent.parent)",
        "os.path.dirname(os.path.join(get_package_share_directory('pkg'), 'launch'))",
        "[ThisLaunchFileDir(), '']",
    ):
        expected = f"{share}/launch" if "ThisLaunch" in text else share
        assert python(f"Node(package={text}, executable='e')").starts[0].package == expected
    node = '<node pkg="{}" exec="e"/>'
    assert xml(node.format("$(find-pkg-share pkg)")).starts[0].package == share
    assert xml(node.format("$(dirname)")).starts[0].package == f"{share}/launch"
    assert xml(node.format("$(filename)")).starts[0].package == f"{share}/launch/app.launch.xml"


def test_a_package_below_the_ament_prefix(xml, tmp_path):
    (tmp_path / "opt" / "share" / "other").mkdir(parents=True)
    environ = {"AMENT_PREFIX_PATH": f"{tmp_path}/none:{tmp_path}/opt"}
    node = '<node pkg="{}" exec="e"/>'
    found = xml(node.format("$(find-pkg-share other)"), environ).starts[0].package
    assert found == f"{tmp_path}/opt/share/other"
    assert (
        xml(node.format("$(find-pkg-prefix other)"), environ).starts[0].package == f"{tmp_path}/opt"
    )
    executable = xml(node.format("$(exec-in-pkg run other)"), environ).starts[0].package
    assert executable == f"{tmp_path}/opt/lib/other/run"


@pytest.mark.parametrize(
    ("python_text", "xml_text", "shown"),
    [
        ("LaunchConfiguration('a')", "$(var a)", "{a}"),
        ("['s_', LaunchConfiguration('a'), '/t']", "s_$(var a)/t", "s_{a}/t"),
        ("EnvironmentVariable('NO')", "$(env NO)", "{env NO}"),
        ("Command(['cat ', LaunchConfiguration('a')])", "$(command 'cat $(var a)')", "{a}"),
        ("Command('ls')", "$(command ls)", "{command ls}"),
        ("FindPackageShare('no')", "$(find-pkg-share no)", "{find-pkg-share no}"),
        ("get_package_share_directory('no') + '/x'", None, "{find-pkg-share no}/x"),
        ("PythonExpression(['not ', LaunchConfiguration('a')])", "$(eval 'not $(var a)')", "{a}"),
        ("PythonExpression('open(1)')", "$(eval 'open(1)')", "{eval open(1)}"),
        ("AnySubstitution('0', LaunchConfiguration('a'))", "$(any 0 $(var a))", "{a}"),
        ("ExecutableInPackage('x', 'pkg')", "$(exec-in-pkg x pkg)", "{exec-in-pkg x pkg}"),
        (None, "$(param robot_name)", "{param robot_name}"),
        ("FileContent('x')", None, "{file-content x}"),
        ("os.environ['NO']", None, "{NO}"),
        ("open('/etc/hostname').read()", None, "{file}"),
    ],
)
def test_what_has_no_value_stands_in_braces_and_is_noted(python, xml, python_text, xml_text, shown):
    apps = []
    if python_text is not None:
        apps.append(python(f"Node(package={python_text}, executable='e')"))
    if xml_text is not None:
        apps.append(xml(f'<node pkg="{xml_text}" exec="e"/>'))
    for app in apps:
        assert app.starts[0].package == shown
        assert (
            app.unresolved
            or python_text == "open('/etc/hostname').read()"
            or "os.environ" in python_text
            or "get_package" in python_text
        )


def test_what_one_known_argument_decides(python):
    app = python(
        "Node(package=AnySubstitution('1', LaunchConfiguration('a')), executable="
        "AndSubstitution(LaunchConfiguration('a'), 'false'))"
    )
    [node] = app.starts
    assert (node.package, node.program) == ("true", "false")


def test_an_argument_that_is_not_given_is_noted_once(python):
    app = python(
        "".join(f"Node(package=LaunchConfiguration('a'), executable='{n}')," for n in "xyz")
    )
    assert whys(app) == ["argument 'a' is not given"]


def test_a_substitution_that_the_launch_file_defines_itself(program):
    app = program("""
from launch import Substitution
class Twice(Substitution):
    def __init__(self, text):
        self.text = text
    def perform(self, context):
        return self.text.perform(context) * 2
def generate_launch_description():
    twice = Twice(LaunchConfiguration('a', default='x'))
    return LaunchDescription([Node(package='p', executable='e', name=[twice, '_n'])])
""")
    assert names(app) == ["/xx_n"]


def test_an_anonymous_name_is_a_pattern(python, xml):
    assert names(python("Node(executable='e', name=AnonName('n'))")) == ["/n_*"]
    assert names(xml('<node pkg="p" exec="e" name="$(anon n)"/>')) == ["/n_*"]


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("list(set('a_b'.split('_')).intersection(['b']))", "['b']"),
        ("sorted({'b', 'a'})[0]", "a"),
        ("any([x == 'b' for x in ['a', 'b']])", "True"),
        ("{'k': 'v'}.get('k')", "v"),
        ("'/'.join([x.upper() for x in 'ab' if x != 'a'])", "B"),
        ("len({x for x in [1, 1, 2]})", "2"),
        ("int(math.sqrt(16))", "4"),
        ("sqrt(16) + math.floor(2.5)", "6.0"),
        ("round(math.pi, 2)", "3.14"),
        ("'a/b'.split('/')[1].upper()", "B"),
        ("[math.x for math in [{'x': 1}]] if False else math.isclose(1, 1)", "True"),
    ],
)
def test_expressions_of_python(xml, text, value):
    quoted = text.replace("'", "\\'").replace("<", "&lt;")
    assert xml(f"""<node pkg="$(eval '{quoted}')" exec="e"/>""").starts[0].package == value


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("os.getcwd()", "`os` is not looked into here"),
        ("os.path.sep", "`os.path` is not looked into here"),
        ("math.factorial(3)", "math has more than is known here"),
        ("math.len([1])", "math has more than is known here"),
        ("nonsense + 1", "the name 'nonsense' is not defined"),
        ("str(range)", "`range` is not of what is evaluated here"),
    ],
)
def test_what_is_not_known_of_an_expression_is_told(xml, text, why):
    (note,) = xml(f"""<node pkg="$(eval '{text}')" exec="e"/>""").unresolved
    assert why in note.why


def test_the_module_math_stands_behind_its_name(python):
    app = python("Node(executable='e', name=PythonExpression(['\"n\" + str(math.ceil(1.5))']))")
    assert names(app) == ["/n2"]
    assert app.unresolved == ()


@pytest.mark.parametrize(
    "text",
    [
        "__import__(1)",
        "().__class__",
        "[x for x in range(10)]",
        "[1 for a in [1]*9 for b in [1]*9]",
        "'x' * 99999",
        "9 ** 9 ** 9",
        "(lambda: 1)()",
        "[a for a in " + "'" + "x" * 300 + "'" + "]",
    ],
)
def test_an_expression_outside_the_grammar_is_noted(xml, text):
    quoted = text.replace("'", "\\'")
    app = xml(f"""<node pkg="$(eval '{quoted}')" exec="e"/>""")
    assert app.starts[0].package.startswith("{eval")
    assert len(app.unresolved) == 1
