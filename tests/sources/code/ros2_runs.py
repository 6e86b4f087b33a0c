"""Runs a ROS 2 node's source text alone; a launch names it /ns/n unless a test says otherwise."""

from pathlib import Path
from tempfile import TemporaryDirectory

from rtron.sources.code.program_runner import run_component, run_cpp, run_python
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeSite, ParameterSetting
from rtron.sources.workspace import Workspace

CPP = """#include <rclcpp/rclcpp.hpp>
{top}
class N : public rclcpp::Node {{
public:
  explicit N(const rclcpp::NodeOptions & options = rclcpp::NodeOptions())
  : rclcpp::Node("written", options) {{
    {body}
  }}
  {members}
}};
int main(int argc, char ** argv) {{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<N>());
}}
"""
PYTHON = """import rclpy
from rclpy.node import Node
from std_msgs.msg import Bool
{top}


class N(Node):
    def __init__(self):
        super().__init__('written')
{body}

{members}


def main():
    rclpy.init()
    rclpy.spin(N())
"""
UNLAUNCHED = {
    "name": "/exe",
    "has_launch_name": False,
    "has_launch_namespace": False,
    "parameters_complete": False,
}


def site(**given):
    return NodeSite(**{"name": "/ns/n", "ros": 2, **given})


def settings(node="/**", **values):
    """Return what a launch sets; `__` stands for a dot."""
    return tuple(
        ParameterSetting(node=node, name=name.replace("__", "."), value=value)
        for name, value in values.items()
    )


def run_text(text, suffix="cpp", cls="", **given):
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"n.{suffix}"
        path.write_text(text)
        files = WorkspaceSources(Workspace({"p": Path(folder)}, [Path(folder)]))
        if suffix == "py":
            return run_python(path, site(**given), files, "main")
        if cls:
            return run_component((path,), cls, site(**given), files)
        return run_cpp((path,), site(**given), files)


def cpp(body, top="", members="", **given):
    """Run the body of a node's constructor."""
    return run_text(CPP.format(top=top, body=body, members=members), **given)


def python(body, top="", members="", **given):
    """Run the end of a node's `__init__`."""
    lines = "\n".join(" " * 8 + line for line in body.splitlines())
    inner = "\n".join(" " * 4 + line for line in members.splitlines())
    return run_text(PYTHON.format(top=top, body=lines, members=inner), "py", **given)


def explicit_declarations(interface):
    """Return what is declared by the program itself, as `kind name type`."""
    return [f"{d.kind.value} {d.name} {d.type}" for d in interface.declarations if not d.implicit]


def implicit_declarations(interface):
    """Return what libraries declare, as `kind name`."""
    return {f"{d.kind.value} {d.name}" for d in interface.declarations if d.implicit}


def names(interface):
    return [d.name for d in interface.declarations if not d.implicit]


def only_declaration(interface):
    """Return the only declaration of the program itself."""
    (found,) = [d for d in interface.declarations if not d.implicit]
    return found
