"""What RTron's code uses of ROS 2's libraries, read from its source text.

A use has a name: an import or an attribute by its path (`rclpy.qos.QoSProfile`), what is used of an
object by its owner (`Node.create_client`), an argument in brackets behind what is called
(`Node.create_client(qos_profile)`), a function of C by its own name. What has a replacement where
it is missing, in a `try` with `except ImportError`, is one of several alternatives.
"""

import ast
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

SOURCE = Path(__file__).parents[3] / "src" / "rtron"
_LIBRARIES = ("rclpy", "action_msgs", "rosidl_runtime_py")
_C_FUNCTION = re.compile(r"(?:rcl|rmw|rcutils)_[a-z0-9_]+(?<!_t)")
_NAMED_FUNCTION = re.compile(r"rcl_[a-z0-9_]+(?<!_t)")
_OBJECTS = {
    "_node": "Node",
    "ros_node": "Node",
    "client": "Client",
    "_publisher": "Publisher",
    "publisher": "Publisher",
    "subscription": "Subscription",
    "_subscription": "Subscription",
    "service": "Service",
    "handle": "handle",
    "_stop_condition": "handle",
    "wait_set": "WaitSet",
    "meta": "message class",
    "action_class": "action class",
    "impl": "action class",
}
"""The owner of what is used of the objects of rclpy that are called so."""
_ROOMS = {
    "wire/ros2": {**_OBJECTS, "context": "Context", "info": "TopicEndpointInfo"},
    "guard/transport/ros2": _OBJECTS,
    "sources/live/ros2": {"_node": "Node"},
}
_OTHERS = frozenset(
    {"Subscription.close", "TopicEndpointInfo.gid", "TopicEndpointInfo.node_entities_info_seq"}
)
"""Uses of the transport's own `Subscription`, and of a message, which a variable is called for."""
_ANNOTATED = ("Node", "QoSProfile", "Duration", "TopicEndpointInfo")

Alternatives = frozenset[str]
"""The names of which a release must have one."""


@cache
def uses() -> dict[Alternatives, str]:
    """Return all that RTron uses, each with a place where."""
    found: dict[Alternatives, str] = {}
    for room, objects in _ROOMS.items():
        for file in sorted((SOURCE / room).glob("*.py")):
            reader = _Reader(objects)
            reader.visit(ast.parse(file.read_text()))
            for names, line in reader.found:
                found.setdefault(names, f"{file.relative_to(SOURCE)}:{line}")
    return found


class _Reader(ast.NodeVisitor):
    """Collects the uses in one file."""

    def __init__(self, objects: dict[str, str]) -> None:
        self.found: list[tuple[Alternatives, int]] = []
        self._objects = objects
        self._paths: dict[str, str] = {}
        self._replacements: dict[str, Alternatives] = {}
        self._annotated: dict[str, str] = {}

    def visit_If(self, node: ast.If) -> None:
        """Leave out what is imported for the type checker alone."""
        if ast.unparse(node.test) != "TYPE_CHECKING":
            self.generic_visit(node)

    def visit_Try(self, node: ast.Try) -> None:
        """Join what is imported in turn to alternatives."""
        handled = [each for each in node.handlers if each.type and each.body]
        is_import = any(ast.unparse(each.type) == "ImportError" for each in handled if each.type)
        others = [each for handler in handled for each in handler.body]
        if not is_import or not all(isinstance(each, ast.ImportFrom) for each in others):
            self.generic_visit(node)
            return
        names = [name for each in (*node.body, *others) for name in self._imported(each)]
        self._replacements |= dict.fromkeys(names, frozenset(names))
        self._add(names[0], node)

    def visit_Import(self, node: ast.Import) -> None:
        """Take an import of a module."""
        for each in node.names:
            if each.name.partition(".")[0] in _LIBRARIES:
                self._paths[each.name.partition(".")[0]] = each.name.partition(".")[0]
                self._add(each.name, node)

    def visit_ImportFrom(self, node: ast.ImportFrom) -> None:
        """Take an import from a module."""
        for name in self._imported(node):
            self._add(name, node)

    def visit_FunctionDef(self, node: ast.FunctionDef) -> None:
        """Know the arguments that are rclpy's by their annotations."""
        before = self._annotated
        arguments = {
            each.arg: ast.unparse(each.annotation).strip("'\"")
            for each in (*node.args.args, *node.args.kwonlyargs)
            if each.annotation
        }
        known = {name: kind for name, kind in arguments.items() if kind in _ANNOTATED}
        self._annotated = {**before, **known}
        self.generic_visit(node)
        self._annotated = before

    def visit_Attribute(self, node: ast.Attribute) -> None:
        """Take an attribute of a library or of one of its objects."""
        if name := self._name(node):
            self._add(name, node)
        if not self._path(node):
            self.generic_visit(node)

    def visit_Call(self, node: ast.Call) -> None:
        """Take the keywords that a library is called with."""
        name = self._name(node.func)
        for each in node.keywords if name else ():
            if each.arg:
                self._add(f"{name}({each.arg})", node)
        self.generic_visit(node)

    def visit_Constant(self, node: ast.Constant) -> None:
        """Take a function of C that a string names."""
        if isinstance(node.value, str) and _NAMED_FUNCTION.fullmatch(node.value):
            self._add(node.value, node)

    def _imported(self, node: ast.stmt) -> list[str]:
        """Return what an import takes from a library, and know it by its name from now on."""
        if not isinstance(node, ast.ImportFrom) or node.level:
            return []
        if str(node.module).partition(".")[0] not in _LIBRARIES:
            return []
        paths = {each.asname or each.name: f"{node.module}.{each.name}" for each in node.names}
        self._paths |= paths
        return list(paths.values())

    def _name(self, node: ast.expr) -> str:
        """Return the name of a use, "" if it is none."""
        if not isinstance(node, ast.Attribute) or self._path(node):
            return self._path(node)
        if _C_FUNCTION.fullmatch(node.attr) and _is_shared_library(node.value):
            return node.attr
        owner, name = self._owner(node.value), node.attr
        is_known = not owner or hasattr(str, name) or name.startswith("__")
        return "" if is_known or f"{owner}.{name}" in _OTHERS else f"{owner}.{name}"

    def _path(self, node: ast.expr) -> str:
        """Return the path of what was imported, or of an attribute of it; "" if it is none."""
        if isinstance(node, ast.Name):
            return self._paths.get(node.id, "")
        path = self._path(node.value) if isinstance(node, ast.Attribute) else ""
        return f"{path}.{node.attr}" if path and isinstance(node, ast.Attribute) else ""

    def _owner(self, node: ast.expr) -> str:
        """Return what an expression is of, "" if that is not known."""
        if isinstance(node, ast.Attribute):
            return "Node" if node.attr == "node" else self._objects.get(node.attr, "")
        if not isinstance(node, ast.Name):
            return ""
        return self._annotated.get(node.id) or self._objects.get(node.id, "")

    def _add(self, name: str, node: ast.AST) -> None:
        """Add a use, or the alternatives that replace each other in it."""
        names = frozenset({name})
        for path, replacements in self._replacements.items():
            if name == path or name.startswith((f"{path}.", f"{path}(")):
                names = frozenset(each + name.removeprefix(path) for each in replacements)
        self.found.append((names, getattr(node, "lineno", 0)))


def _is_shared_library(node: ast.expr) -> bool:
    """Return whether a name or call is a library that ctypes has loaded."""
    text = ast.unparse(node)
    return "CDLL(" in text or text.rpartition(".")[2] in ("rcl", "rmw", "_rmw", "utils")


def structures() -> Iterator[str]:
    """Yield the names of the structures of C that are laid out in RTron's code."""
    tree = ast.parse((SOURCE / "wire/ros2/c_structures.py").read_text())
    for node in tree.body:
        if isinstance(node, ast.ClassDef) and "Structure" in map(ast.unparse, node.bases):
            yield node.name
