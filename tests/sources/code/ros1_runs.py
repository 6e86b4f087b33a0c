"""Runs a node's source text alone, as the node /ns/n."""

from pathlib import Path
from tempfile import TemporaryDirectory

from rtron.sources.code.program_runner import run_cpp, run_python
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeSite
from rtron.sources.workspace import Workspace

PYTHON = """import rospy
from std_msgs.msg import Bool


def P(name):
    rospy.Publisher(name, Bool)


"""
CPP = """#include <ros/ros.h>
#include <std_msgs/Bool.h>
{top}
int main(int argc, char** argv) {{
  ros::NodeHandle nh;
  {body}
}}
"""


def run_text(text, suffix="py", **site):
    """Return what a program of one file declares; `text` may be bytes."""
    data = text if isinstance(text, bytes) else text.encode("utf-8", "surrogatepass")
    with TemporaryDirectory() as folder:
        path = Path(folder) / f"n.{suffix}"
        path.write_bytes(data)
        files = WorkspaceSources(Workspace({"p": Path(folder)}, [Path(folder)]))
        at = NodeSite(name="/ns/n", **site)
        return run_python(path, at, files) if suffix == "py" else run_cpp((path,), at, files)


def python(body, **site):
    """Run Python in which `P(name)` advertises."""
    return run_text(PYTHON + body, **site)


def cpp(body, top="", **site):
    """Run the body of a main."""
    return run_text(CPP.format(top=top, body=body), "cpp", **site)


def names(interface):
    """Return what is declared, relative to /ns."""
    return [declared.name.removeprefix("/ns/") for declared in interface.declarations]
