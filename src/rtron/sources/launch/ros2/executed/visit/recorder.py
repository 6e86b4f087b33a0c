"""Takes down what would start: processes, nodes, components, and what a launch file declares."""

import os
from collections.abc import Callable
from pathlib import Path
from typing import Any, TypeAlias

from launch_ros.actions import ComposableNodeContainer, LifecycleNode, Node
from launch_ros.actions.load_composable_nodes import get_composable_node_load_request

from .event_patches import current_event
from .locations import context_local, creation_location
from .substitution_patches import perform_text
from .visit_record import Values, VisitRecord, location_fields

Thing: TypeAlias = Any
Method: TypeAlias = Callable[..., Any]

_ARGUMENT_COUNT = "_rtron_words"
_VALUE_FIELDS = {
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


class LaunchRecorder:
    """Keeps what the launch of the file `root` does."""

    def __init__(self, record: VisitRecord, root: str) -> None:
        self._record = record
        self._root = root
        self._environ = dict(os.environ)

    def count_arguments(self, original: Method, node: Thing, **arguments: Thing) -> object:
        """Count the words that a node is given: in its command line they stand first."""
        for key in ("arguments", "ros_arguments"):
            if arguments.get(key) is not None:
                arguments[key] = list(arguments[key])
        ros = arguments.get("ros_arguments")
        count = len(arguments.get("arguments") or ()) + (0 if ros is None else 1 + len(ros))
        setattr(node, _ARGUMENT_COUNT, count)
        return original(node, **arguments)

    def execute_process(self, original: Method, action: Thing, context: Thing) -> object:
        """Let launch make the command line of a process, and keep it."""
        result = original(action, context)
        command, environ = action.process_details["cmd"], action.process_details.get("env")
        changed = {k: v for k, v in (environ or {}).items() if self._environ.get(k) != v}
        prefix_length = len(command) - len(action.process_description.cmd)
        node_fields = (
            self._node_fields(action, context, command[prefix_length:])
            if isinstance(action, Node)
            else {}
        )
        started = {"kind": "process", "words": list(command[prefix_length:]), "environ": changed}
        start = {**started, **node_fields, "shell": action.shell is True}
        self._add_start(start, action, context)
        return result

    def _node_fields(self, action: Thing, context: Thing, command: list[str]) -> Values:
        """Return what a node has beside a process: its own words, and those that launch adds."""
        end = 1 + getattr(action, _ARGUMENT_COUNT)
        return {
            "kind": _kind(action),
            "package": perform_text(context, action.node_package),
            "program": perform_text(context, action.node_executable),
            "words": list(command[1:end]),
            "added": list(command[end:]),
        }

    def execute_load(self, _: Method, action: Thing, context: Thing) -> None:
        """Keep the components that a container would be asked to load."""
        target = action._LoadComposableNodes__target_container  # noqa: SLF001 - no other way
        name = target.node_name if isinstance(target, Node) else perform_text(context, target)
        for description in action._LoadComposableNodes__composable_node_descriptions:  # noqa: SLF001
            request = get_composable_node_load_request(description, context)
            if request is not None:
                loaded = {"container": name, **_load_request_fields(request)}
                self._add_start(loaded, description, context)

    def evaluate_parameter_file(self, original: Method, file: Thing, context: Thing) -> object:
        """Note a parameter file that is not there: launch goes on without it."""
        path = original(file, context)
        if not Path(str(path)).is_file():
            why = f"{path} is no file here: its parameters are not known"
            self._record.note(why, creation_location(file, context))
        return path

    def execute_declare(self, original: Method, action: Thing, context: Thing) -> object:
        """Keep an argument that the root file declares."""
        if context_local(context, "current_launch_file_path") == self._root:
            default = action.default_value
            declared = {
                "name": action.name,
                "default": None if default is None else perform_text(context, default),
                "description": str(action.description or ""),
                "place": location_fields(creation_location(action, context)),
            }
            self._record.arguments.append(declared)
        return original(action, context)

    def execute_include(self, original: Method, action: Thing, context: Thing) -> object:
        """Keep which file is included, and with what."""
        location = creation_location(action, context)
        result = original(action, context)
        passed = [
            [perform_text(context, part) for part in pair] for pair in action.launch_arguments
        ]
        file = str(context_local(context, "current_launch_file_path") or "")
        if location[0]:
            included = {"file": file, "arguments": passed, "place": location_fields(location)}
            self._record.includes.append(included)
        return result

    def _add_start(self, started: Values, thing: Thing, context: Thing) -> None:
        location = location_fields(creation_location(thing, context))
        self._record.starts.append({**started, "event": current_event(context), "place": location})


def _kind(action: Thing) -> str:
    kinds = ((LifecycleNode, "lifecycle_node"), (ComposableNodeContainer, "container"))
    return next((kind for cls, kind in kinds if isinstance(action, cls)), "node")


def _load_request_fields(request: Thing) -> Values:
    """Return a request to load a component (composition_interfaces/LoadNode)."""
    return {
        "kind": "component",
        "package": request.package_name,
        "program": request.plugin_name,
        "name": request.node_name,
        "namespace": request.node_namespace,
        "remaps": list(request.remap_rules),
        "parameters": [_parameter(parameter) for parameter in request.parameters],
        "extra": [_parameter(parameter) for parameter in request.extra_arguments],
    }


def _parameter(message: Thing) -> list[Any]:
    """Return a parameter's name and value (rcl_interfaces/Parameter)."""
    value = getattr(message.value, _VALUE_FIELDS[message.value.type])
    content = value if isinstance(value, (bool, int, float, str)) else list(value)
    if message.value.type == 5:  # noqa: PLR2004 - of bytes, each one
        content = [int.from_bytes(byte, "big") for byte in value]
    return [message.name, content]
