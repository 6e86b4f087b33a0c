"""Functions of rclcpp that stand in namespaces."""

from collections.abc import Callable, Mapping

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Hole,
    Known,
    Value,
    is_text,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common.names import below, expanded

_UNKNOWN = Hole("?")
_INTERFACES = ("base", "clock", "graph", "logging", "parameters", "services", "timers", "topics")


def _interface(_: Machine, __: object, arguments: Arguments) -> Value:
    """`rclcpp::node_interfaces::get_node_topics_interface(node)`: the node stands for it."""
    return arguments.get(0) or NONE


def _expand(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`rclcpp::expand_topic_or_service_name(name, node_name, namespace)`."""
    del machine
    name, node, space = (arguments.get(at) or _UNKNOWN for at in range(3))
    return expanded(name, below(space, node), Known(""))


def _replace(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`std::replace(text.begin(), text.end(), '/', '_')` changes the text."""
    place = arguments.place(0)
    text = place.holder.get(place.key) if place is not None else None
    old, new = arguments.get(2), arguments.get(3)
    known = [v.value for v in (text, old, new) if isinstance(v, Known) and is_text(v)]
    if place is not None and text is not None:
        all_known = len(known) == len((text, old, new)) and isinstance(text, Known)
        after = Known(known[0].replace(known[1], known[2]), text.tainted) if all_known else None
        machine.trail.set(*place, after or Hole(str(place.key)))
    return NONE


def _share(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`ament_index_cpp::get_package_share_directory(package)`: where its source lies."""
    name = arguments.get(0)
    path = machine.world.files.package_path(str(name.value)) if isinstance(name, Known) else None
    return Hole("package_share") if path is None else Known(str(path))


def _no_node(_: Machine, __: object, ___: Arguments) -> Value:
    return Hole("ok")


FUNCTIONS: Mapping[str, Callable[..., Value]] = {
    **{f"rclcpp::node_interfaces::get_node_{name}_interface": _interface for name in _INTERFACES},
    "rclcpp::expand_topic_or_service_name": _expand,
    "rclcpp::ok": _no_node,
    **{f"ament_index_cpp::get_package_share_{what}": _share for what in ("directory", "path")},
    "std::replace": _replace,
}
