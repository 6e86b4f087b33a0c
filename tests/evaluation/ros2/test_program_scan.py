"""All programs of a ROS 2 workspace, scanned without a launch."""

import pytest
from file_tree import write

from evaluation.ros2.program_scan import ros2_programs, scan_programs
from rtron.sources.declaration import NodeSite
from rtron.sources.static.common.scan_options import ScanOptions
from rtron.sources.static.common.task import TaskKind, component_task, executable_task
from rtron.sources.static.ros2.app import read_ros2_workspace

NODE = """#include <rclcpp/rclcpp.hpp>
namespace app {{ class {cls} : public rclcpp::Node {{ public:
  explicit {cls}(const rclcpp::NodeOptions & options) : Node("{name}", options) {{
    create_publisher<std_msgs::msg::Bool>("{name}_out", 1); }} }}; }}
"""
CMAKE = """project(p)
add_library(parts made.cpp loaded.cpp)
rclcpp_components_register_nodes(parts "app::Made" "app::Loaded")
add_executable(made main.cpp)
target_link_libraries(made parts)
add_executable(check test/check.cpp)
install(PROGRAMS scripts/tool.py DESTINATION lib/p)
"""
MAIN = '#include "made.hpp"\nint main() { rclcpp::spin(std::make_shared<app::Made>(o)); }\n'
TOOL = """#!/usr/bin/env python3
import rclpy
from std_msgs.msg import Bool
node = rclpy.create_node('tool')
node.create_publisher(Bool, 'tool_out', 1)
"""
SETUP = (
    "from setuptools import setup\nsetup(entry_points={'console_scripts': ['run = q.run:main']})"
)
RUN = """import rclpy
from std_msgs.msg import Bool
def main():
    node = rclpy.create_node('runner')
    node.create_publisher(Bool, 'run_out', 1)
"""


@pytest.fixture
def folder(tmp_path):
    write(
        tmp_path,
        {
            "p/package.xml": "<package><name>p</name><depend>q</depend></package>",
            "p/CMakeLists.txt": CMAKE,
            "p/made.cpp": NODE.format(cls="Made", name="made"),
            "p/loaded.cpp": NODE.format(cls="Loaded", name="loaded"),
            "p/main.cpp": MAIN,
            "p/test/check.cpp": MAIN,
            "p/scripts/tool.py": TOOL,
            "q/package.xml": "<package><name>q</name></package>",
            "q/setup.py": SETUP,
            "q/q/__init__.py": "",
            "q/q/run.py": RUN,
        },
    )
    return tmp_path


def test_each_program_once_and_no_test(folder):
    tasks = list(ros2_programs(read_ros2_workspace([folder]), folder))
    assert [(package, task.kind, task.site.name) for package, task in tasks] == [
        ("p", TaskKind.CPP, "/made"),
        ("p", TaskKind.PYTHON, "/tool.py"),
        ("p", TaskKind.COMPONENT, "/Loaded"),
        ("q", TaskKind.PYTHON, "/run"),
    ]


def test_each_program_is_a_node_of_its_own_name(folder):
    options = ScanOptions(workers=1)
    scanned = list(scan_programs(read_ros2_workspace([folder]), folder, options))
    found = {
        (declared.node, declared.name)
        for one in scanned
        for declared in one.result.interface.declarations
        if not declared.implicit
    }
    assert found == {
        ("/made", "/made_out"),
        ("/tool", "/tool_out"),
        ("/loaded", "/loaded_out"),
        ("/runner", "/run_out"),
    }


def test_a_full_cache_gives_the_same(folder, tmp_path):
    options = ScanOptions(workers=1, cache=tmp_path / "cache")
    both = [list(scan_programs(read_ros2_workspace([folder]), folder, options)) for _ in range(2)]
    cold, warm = ({one.task.site.name: one.result for one in scanned} for scanned in both)
    assert cold == warm
    assert len(warm) == 4


def test_a_launch_gives_a_program_its_site(folder):
    found, site = read_ros2_workspace([folder]), NodeSite(name="/cell/n", ros=2)
    assert executable_task(found, "p", "made", site).kind is TaskKind.CPP
    assert executable_task(found, "q", "run", site).class_name == "main"
    assert executable_task(found, "q", "gone", site) is None
    task = component_task(found, "p", "app::Loaded", site)
    assert (task.kind, task.class_name, task.site) == (TaskKind.COMPONENT, "app::Loaded", site)
    assert component_task(found, "p", "app::Gone", site) is None
