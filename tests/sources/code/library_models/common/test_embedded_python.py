"""C++ programs that run Python in their own process (pybind11)."""

import ros2_runs
from ros2_runs import UNLAUNCHED, site

from rtron.sources.code.program_runner import run_cpp
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.static.ros2.app import read_ros2_workspace

INCLUDED = "#include <pybind11/embed.h>\nnamespace py = pybind11;"
CONTROL = """
from rclpy.node import Node
from std_msgs.msg import Bool
class Control:
    def __init__(self, simulated, name):
        self.node = Node('control_py')
        self.node.declare_parameter('rate', 10)
        self.node.create_publisher(Bool, 'state', 1)
"""


def run(tmp_path, body):
    program = ros2_runs.CPP.format(top=INCLUDED, body=body, members="")
    for name, text in {
        "package.xml": "<package><name>hybrid</name></package>",
        "CMakeLists.txt": "project(hybrid)\nament_python_install_package(hybrid)",
        "src/main.cpp": program,
        "hybrid/__init__.py": "",
        "hybrid/control.py": CONTROL,
    }.items():
        (tmp_path / "hybrid" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "hybrid" / name).write_text(text)
    files = WorkspaceSources(read_ros2_workspace([tmp_path]))
    return run_cpp((tmp_path / "hybrid/src/main.cpp",), site(**UNLAUNCHED), files)


def test_what_a_module_of_python_makes_is_a_part_of_the_program(tmp_path):
    found = run(
        tmp_path,
        """auto control = py::module::import("hybrid.control");
        auto made = control.attr("Control")(true, "x");
        made.attr("tick")();
        create_publisher<std_msgs::msg::Bool>("own", 1);""",
    )
    assert [(d.node, d.name) for d in found.declarations if not d.implicit] == [
        ("/written", "/own"),
        ("/control_py", "/state"),
    ]
    assert ("/control_py", "rate", 10) in [(p.node, p.name, p.value) for p in found.parameters]
    remapped = {made.name: made.uses_global_arguments for made in found.nodes}
    assert remapped == {"/written": True, "/control_py": False}
    assert found.unresolved == ()


def test_python_that_is_not_here_or_not_known_is_noted(tmp_path):
    found = run(
        tmp_path,
        """py::module_::import("other").attr("Node")();
        py::module_::import(name).attr("Node")();
        py::exec("import rclpy");""",
    )
    assert sorted(note.what for note in found.unresolved) == [
        "Python of {name}",
        "exec",
        "other.Node",
    ]
