"""What a shell runs in a launch is as if the launch ran it."""

import pytest
from app_launch_values import values, whys

from rtron.sources.launch.ros2.shell import split_commands

RUN = "ros2 run c n --ros-args -p a:=1 -r __node:=m --params-file"


@pytest.mark.parametrize(
    "process",
    [
        "cmd=['{}']",
        "cmd=['bash', '-c', '{}']",
        "cmd=['bash', '-lc', '{}; sleep 5']",
        "cmd=['sleep 5\\n{} >log'], shell=True",
        "cmd=['/opt/ros/bin/{}', '&'], shell=True",
    ],
)
def test_a_node_has_its_parameters(python, package, process):
    (package / "p.yaml").write_text("/m:\n  ros__parameters:\n    b: text\n")
    app = python(f"ExecuteProcess({process.format(f'{RUN} {package}/p.yaml')})")
    (node,) = [start for start in app.starts if start.program]
    assert (node.package, node.program, node.full_name) == ("c", "n", "/m")
    assert values(node) == {"a": 1, "b": "text"}
    assert app.unresolved == ()


def test_each_command_is_started_in_order(xml):
    script = "ros2 run a b -r x:=y &amp;&amp; ros2 run c d"
    app = xml(f"<executable cmd=\"bash -c '{script}'\"/><executable cmd='ls ;' shell='true'/>")
    assert [(start.package, start.arguments) for start in app.starts] == [
        ("a", ("-r", "x:=y")),
        ("c", ()),
        ("", ("ls",)),
    ]


def test_too_many_commands_end_it(python):
    app = python(f"ExecuteProcess(cmd=['{'a;' * 2_001}'], shell=True)")
    assert len(app.starts) == 2_000
    assert any("more than 2000 nodes" in why for why in whys(app))


@pytest.mark.parametrize("part", ["'", '"', "$(", "`", "<", "\\", "(", "\ue000", "bash -c '", "<<"])
def test_hostile_lines_end(part):
    assert len(list(split_commands([part * 9_000, "x"], shell=True))) <= 9_001
