"""ROS's own launch file loader, asked from another Python: the truth our own is held to."""

import json
import subprocess
from pathlib import Path

from file_tree import write

from rtron.sources.launch.common.packages import find_packages

DUMP = Path(__file__).with_name("roslaunch_dump.py")
ROS_PYTHON = "/usr/bin/python3"
ANONYMOUS = "_rtron_anonymous"


class RosLoader:
    """A running roslaunch_dump.py; `load` answers with what ROS would start, or its error."""

    def __enter__(self):
        self._process = subprocess.Popen(
            [ROS_PYTHON, DUMP],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        return self

    def __exit__(self, *_):
        self._process.stdin.close()
        self._process.stdout.close()
        self._process.kill()
        self._process.wait()

    def load(self, path, args=None, environ=None):
        return self.ask({"path": str(path), "args": args or {}, "environ": environ or {}})

    def ask(self, request):
        self._process.stdin.write(json.dumps(request) + "\n")
        self._process.stdin.flush()
        return json.loads(self._process.stdout.readline())


def started(dump):
    """Return what our LaunchTree is compared by: name -> (package, type, args, remaps)."""
    nodes = [*dump["nodes"], *dump["tests"]]
    return {
        _pattern(node["full_name"]): (
            node["package"],
            node["type"],
            _pattern(node["args"]),
            [(_pattern(a), _pattern(b)) for a, b in node["resolved_remaps"]],
        )
        for node in nodes
    }


def nodes_of_tree(tree):
    return {
        node.name: (
            node.package,
            node.type,
            node.args,
            [(remap.source, remap.target) for remap in node.remaps],
        )
        for node in tree.nodes()
    }


def package(name):
    return f"<package><name>{name}</name></package>"


def both(ros, folder, case):
    """Write a case; return what ROS makes of it, and the arguments with which we read it."""
    write(folder, {"app.launch": f"<launch>{case.body}</launch>", **case.files})
    write(folder, {f"{name}/package.xml": package(name) for name in ("one", "two")})
    environ = {"WHO": "me", **case.environ, "ROS_PACKAGE_PATH": str(folder)}
    path = folder / "app.launch"
    ours = (path, case.args, find_packages([], environ), environ)
    return ros.load(path, case.args, environ), ours


def _pattern(text):
    return text.replace(ANONYMOUS, "_*")
