"""Takes down what would start: processes, nodes, components, and what a launch file declares."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

from launch_ros.actions import ComposableNodeContainer, LifecycleNode, Node
from launch_ros.actions.load_composable_nodes import get_composable_node_load_request

from .event_patches import event_of
from .locations import local, remembered
from .substitution_patches import text
from .visit_record import Found, Values, placed

Thing: TypeAlias = Any
Method: TypeAlias = Callable[..., Any]

_WORDS = "_rtron_words"
_OF_VALUE = {
    1: "bool_value",
    2: "integer_value",
    3: "double_value",
    4: "string_value",
    5: "byte_array_value",
    6: "bool_array_value",
    7: "integer_array_value",
    8: "double_array_value",
    9: "string_array_value",
}
"""rcl_interfaces/ParameterType: the field of a ParameterValue by its type."""


class Recording:
    """Keeps what the launch of the file `root` does."""

    def __init__(self, found: Found, root: str) -> None:
        self._found = found
        self._root = root
        self._environ = dict(os.environ)

    def counting(self, original: Method, node: Thing, **given: Thing) -> object:
        """Count the words that a node is given: in its command line they stand first."""
        for key in ("arguments", "ros_arguments"):
            if given.get(key) is not None:
                given[key] = list(given[key])
        ros = given.get("ros_arguments")
        count = len(given.get("arguments") or ()) + (0 if ros is None else 1 + len(ros))
        setattr(node, _WORDS, count)
        return original(node, **given)

    def executing(self, original: Method, action: Thing, context: Thing) -> object:
        """Let launch make the command line of a process, and keep it."""
        shared = len(context.launch_configurations.get("ros_remaps") or ())
        result = original(action, context)
        command, environ = action.process_details["cmd"], action.process_details.get("env")
        changed = {k: v for k, v in (environ or {}).items() if self._environ.get(k) != v}
        before = len(command) - len(action.process_description.cmd)
        own = self._node(action, context, command[before:]) if isinstance(action, Node) else {}
        started = {"kind": "process", "words": list(command[before:]), "environ": changed}
        said = {"shell": action.shell is True, "shared": shared}
        self._keep({**started, **own, **said}, action, context)
        return result

    def _node(self, action: Thing, context: Thing, command: list[str]) -> Values:
        """Return what a node has beside a process: its own words, and those that launch adds."""
        end = 1 + getattr(action, _WORDS)
        return {
            "kind": _kind(action),
            "package": text(context, action.node_package),
            "program": text(context, action.node_executable),
            "words": list(command[1:end]),
            "added": list(command[end:]),
        }

    def loading(self, _: Method, action: Thing, context: Thing) -> None:
        """Keep the components that a container would be asked to load."""
        target = action._LoadComposableNodes__target_container  # noqa: SLF001 - no other way
        name = target.node_name if isinstance(target, Node) else text(context, target)
        shared = len(context.launch_configurations.get("ros_remaps") or ())
        for one in action._LoadComposableNodes__composable_node_descriptions:  # noqa: SLF001
            request = get_composable_node_load_request(one, context)
            if request is not None:
                loaded = {"container": name, **_loaded(request), "shared": shared}
                self._keep(loaded, one, context)

    def evaluating(self, original: Method, file: Thing, context: Thing) -> object:
        """Note a parameter file that is not there: launch goes on without it."""
        path = original(file, context)
        if not Path(str(path)).is_file():
            why = f"{path} is no file here: its parameters are not known"
            self._found.note(why, remembered(file, context))
        return path

    def declaring(self, original: Method, action: Thing, context: Thing) -> object:
        """Keep an argument that the root file declares."""
        if local(context, "current_launch_file_path") == self._root:
            default = action.default_value
            declared = {
                "name": action.name,
                "default": None if default is None else text(context, default),
                "description": str(action.description or ""),
                "place": placed(remembered(action, context)),
            }
            self._found.arguments.append(declared)
        return original(action, context)

    def including(self, original: Method, action: Thing, context: Thing) -> object:
        """Keep which file is included, and with what."""
        place = remembered(action, context)
        result = original(action, context)
        given = [[text(context, part) for part in pair] for pair in action.launch_arguments]
        file = str(local(context, "current_launch_file_path") or "")
        if place[0]:
            included = {"file": file, "arguments": given, "place": placed(place)}
            self._found.includes.append(included)
        return result

    def _keep(self, started: Values, thing: Thing, context: Thing) -> None:
        place = placed(remembered(thing, context))
        self._found.starts.append({**started, "event": event_of(context), "place": place})


def _kind(action: Thing) -> str:
    kinds = ((LifecycleNode, "lifecycle_node"), (ComposableNodeContainer, "container"))
    return next((kind for cls, kind in kinds if isinstance(action, cls)), "node")


def _loaded(request: Thing) -> Values:
    """Return a request to load a component (composition_interfaces/LoadNode)."""
    return {
        "kind": "component",
        "package": request.package_name,
        "program": request.plugin_name,
        "name": request.node_name,
        "namespace": request.node_namespace,
        "remaps": list(request.remap_rules),
        "parameters": [_parameter(one) for one in request.parameters],
        "extra": [_parameter(one) for one in request.extra_arguments],
    }


def _parameter(message: Thing) -> list[Any]:
    """Return a parameter's name and value (rcl_interfaces/Parameter)."""
    value = getattr(message.value, _OF_VALUE[message.value.type])
    plain = value if isinstance(value, (bool, int, float, str)) else list(value)
    if message.value.type == 5:  # noqa: PLR2004 - of bytes, each one
        plain = [int.from_bytes(one, "big") for one in value]
    return [message.name, plain]
