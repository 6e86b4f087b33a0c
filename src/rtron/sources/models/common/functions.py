"""What an expression of a model may ask: parameters, arguments, plugin values, files.

A function answers with a Hole where the answer is not known.

param(name, default)        a parameter; is_set(name): whether the launch gives it
search(name, default)       a parameter, searched upwards
children(prefix)            the names below `prefix.`
numbered(name)              the numbers of `name0`, `name1`, …; counted(name): their values
value(name, default)        an element of a Gazebo plugin
robot_namespace()           of a Gazebo sensor plugin; plugin_namespace(): of a model plugin
model()                     the name of a Gazebo model
argument(index, default, valued), positional(valued), words()
                            arguments; `valued` names options that take a value
option(names, default)      the value of an option; has_option(names): whether it is given
resolved(name)              the full name before remapping; remapped(name): after it
since(distribution, unset)  whether `$ROS_DISTRO` is that distribution or a later one
unknown(name)               a value that is unknown before the app runs
truth(value)                a boolean; chosen(condition, yes, no): one of two values
get(tree, key, default), items(list), keys(dict), split(text), range(first, last)
                            parts of a value
prefixed(prefix, frame), basename(name), parent(name)
                            parts of names
matches(name, patterns)     whether a shell pattern fits
fixed_joints(name), moving_joints(name)
                            joints of the robot description in a parameter
yaml_file(path)             a YAML file
lua_setting(folder, name, key, default)
                            what a Lua file assigns last
tree_nodes(path, usual_file, usual)
                            the nodes of a behaviour tree
rviz_subscriptions(path), rviz_publications(path), rviz_move_groups(path)
                            from a configuration of rviz
rviz2_subscriptions(path), rviz2_publications(path), rviz2_markers(path), rviz2_panels(path)
                            from a configuration of rviz2
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from fnmatch import fnmatchcase
from functools import lru_cache, partial
from itertools import takewhile

from rtron.errors import InputError
from rtron.sources.models.common import arguments
from rtron.sources.models.common.model_scope import ModelScope
from rtron.sources.models.common.node_files import read_lua_setting, read_yaml_file, tree_nodes
from rtron.sources.models.common.rviz import rviz_move_groups, rviz_publications, rviz_subscriptions
from rtron.sources.models.common.rviz2 import (
    rviz2_markers,
    rviz2_panels,
    rviz2_publications,
    rviz2_subscriptions,
)
from rtron.sources.models.common.values import (
    Placeholder,
    Value,
    as_switch,
    has_placeholder,
    placeholder,
    with_placeholders,
)
from rtron.sources.xacro import XmlElement, parse_element
from rtron.vocabulary import ParameterValue
from rtron.vocabulary.parameters import pattern_matches

MAX_CHILDREN = 1000
_KINDS = {float: (float, int)}


def parameter_or_default(scope: ModelScope, name: str, default: Value = None) -> Value:
    """Return what is given for a parameter of the scope's node, or its default.

    Raise ValueError where it is of another kind than the default: the node refuses it.
    """
    values = [
        value for parameter_name, value in _launch_parameters(scope) if parameter_name == name
    ]
    value = with_placeholders(values[-1], name) if values else default
    kind = type(default)
    if default is not None and not isinstance(value, (Placeholder, _KINDS.get(kind, kind))):
        raise ValueError(f"parameter {name} is no {kind.__name__}")
    return value


def children(scope: ModelScope, prefix: str) -> list[str]:
    """Return the names right below `prefix.` among the parameters given, in order; '' for all."""
    start = f"{prefix}." if prefix else ""
    names_below = (
        name.removeprefix(start) for name, _ in _launch_parameters(scope) if name.startswith(start)
    )
    return list(dict.fromkeys(name.partition(".")[0] for name in names_below))[:MAX_CHILDREN]


def _launch_parameters(scope: ModelScope) -> Iterator[tuple[str, ParameterValue]]:
    """Yield what is given, the last of a name counts; overrides are the first node's alone.

    Other nodes of the process take its own arguments, in a container as well (nav2's costmaps).
    """
    is_first = scope.private == scope.site.name
    settings = scope.site.node_settings if is_first else scope.site.settings
    yield from ((s.name, s.value) for s in settings if pattern_matches(s.node, scope.private))
    if is_first:
        yield from scope.site.overrides


Function = Callable[..., Value]

LATEST_ROS1, LATEST_ROS2 = "noetic", "rolling"
MAX_COUNTED = 100


def model_functions(scope: ModelScope) -> dict[str, Function]:
    """Return the functions an expression may call in a scope."""
    args = scope.site.args
    return {
        **_PURE_FUNCTIONS,
        "param": partial(_param, scope),
        "is_set": partial(_is_set, scope),
        "search": partial(_search, scope),
        "counted": partial(_numbered_values, scope),
        "children": partial(children, scope),
        "numbered": partial(_existing_numbers, scope),
        "value": partial(_value, scope),
        "fixed_joints": lambda name: joints(_description(scope, name), fixed=True),
        "moving_joints": lambda name: joints(_description(scope, name), fixed=False),
        "since": partial(_since, scope),
        "model": partial(_model, scope),
        "plugin_namespace": partial(_plugin_namespace, scope),
        "robot_namespace": partial(_robot_namespace, scope),
        "resolved": scope.resolve,
        "remapped": scope.remapped,
        "argument": partial(_argument, args),
        "option": partial(_option, args),
        "has_option": partial(arguments.has_option, args),
        "positional": partial(arguments.positional, args),
        "words": partial(arguments.user_arguments, args),
    }


def _param(scope: ModelScope, name: str, default: Value = None) -> Value:
    if scope.is_ros2:
        return parameter_or_default(scope, name, default)
    launch_parameter = scope.site.parameters.get(scope.resolve(name))
    return default if launch_parameter is None else with_placeholders(launch_parameter.value, name)


def _is_set(scope: ModelScope, name: str) -> bool:
    """Return whether a launch gives a parameter, be its value known or not."""
    return _param(scope, name) is not None


def _numbered_values(scope: ModelScope, name: str) -> list[Value]:
    """Return the values of `name0`, `name1`, … up to the first that is not set."""
    values = (_param(scope, f"{name}{number}") for number in range(MAX_COUNTED))
    return list(takewhile(lambda value: value is not None, values))


def _existing_numbers(scope: ModelScope, name: str) -> list[str]:
    """Return `0`, `1`, … as long as a parameter of that name and number is set."""
    numbers = map(str, range(MAX_COUNTED))
    return list(takewhile(lambda number: _param(scope, name + number) is not None, numbers))


def _search(scope: ModelScope, name: str, default: Value = None) -> Value:
    full_name = scope.site.parameters.search(name, scope.private)
    launch_parameter = scope.site.parameters.get(full_name) if full_name else None
    return default if launch_parameter is None else with_placeholders(launch_parameter.value, name)


def _description(scope: ModelScope, name: str) -> Value:
    """Return the robot description of a parameter; ROS 1 looks upwards for one (urdf: Model)."""
    remapped = scope.remapped(name)
    if scope.is_ros2 or remapped != scope.resolve(name):
        return _param(scope, name if scope.is_ros2 else remapped)
    return _search(scope, name)


def _value(scope: ModelScope, name: str, default: Value = None) -> Value:
    """Return what a plugin's element holds, the first of its name (sdformat: GetElement)."""
    tree: Value = scope.variables.get("values", {})
    for part in name.split("/"):
        tree = tree.get(part) if isinstance(tree, Mapping) else None
    tree = tree[0] if isinstance(tree, list) else tree
    if tree is None:
        return default
    return tree.strip() if isinstance(tree, str) and not isinstance(tree, Placeholder) else tree


def _model(scope: ModelScope) -> str:
    return scope.variables.get("model_name") or placeholder("model")


def _plugin_namespace(scope: ModelScope) -> Value:
    """Return the namespace of a model plugin (gazebo_ros_utils.h: GazeboRos)."""
    return _value(scope, "robotNamespace") or _model(scope)


def _robot_namespace(scope: ModelScope) -> Value:
    """Return the namespace of a sensor plugin (gazebo_ros_utils.h: GetRobotNamespace)."""
    namespace = _value(scope, "robotNamespace")
    return "" if namespace is None else namespace or _model(scope)


def _since(scope: ModelScope, distribution: str, unset: Value = None) -> Value:
    known = dict(scope.site.environ).get("ROS_DISTRO")
    if known is None and unset is not None:
        return unset
    return (known or (LATEST_ROS2 if scope.is_ros2 else LATEST_ROS1)) >= distribution


def _argument(args: Sequence[str], index: int, default: Value = None, valued: str = "") -> Value:
    positional_arguments = arguments.positional(args, valued)
    return positional_arguments[index] if index < len(positional_arguments) else default


def _option(args: Sequence[str], names: str, default: Value = None) -> Value:
    value = arguments.option(args, names)
    return default if value is None else value


def _get(tree: Value, key: Value, default: Value = None) -> Value:
    if has_placeholder(tree):
        return placeholder(f"{tree}.{key}")
    if isinstance(tree, Mapping):
        return tree.get(key, default)
    is_in_range = isinstance(tree, (list, tuple)) and isinstance(key, int) and key < len(tree)
    return tree[key] if is_in_range else default


def _split(text: Value) -> Value:
    if isinstance(text, Placeholder):
        return text
    return text.split() if isinstance(text, str) else list(text or ())


def _keys(tree: Value) -> Value:
    if isinstance(tree, Placeholder):
        return tree
    return list(tree) if isinstance(tree, Mapping) else []


def _items(tree: Value) -> Value:
    if isinstance(tree, Placeholder):
        return tree
    return list(tree) if isinstance(tree, (list, tuple)) else []


def _if_else(condition: Value, yes: Value, no: Value) -> Value:
    return yes if as_switch(condition) else no


def _matches(name: Value, patterns: Value) -> Value:
    """Return whether one of some shell patterns fits a name, whatever their case."""
    if isinstance(patterns, Placeholder):
        return patterns
    return any(fnmatchcase(str(name).lower(), str(one).lower()) for one in patterns)


def _prefixed(prefix: Value, frame: Value) -> str:
    """Return a frame with the prefix of its robot; an absolute one has none (tf: resolve)."""
    prefix = str(prefix).strip("/")
    return f"{prefix}/{frame}" if prefix and not str(frame).startswith("/") else str(frame)


_PURE_FUNCTIONS: Mapping[str, Function] = {
    "chosen": _if_else,
    "get": _get,
    "items": _items,
    "keys": _keys,
    "prefixed": _prefixed,
    "split": _split,
    "truth": as_switch,
    "unknown": placeholder,
    "basename": lambda name: str(name).rpartition("/")[2],
    "lua_setting": read_lua_setting,
    "matches": _matches,
    "parent": lambda name: str(name).rpartition("/")[0],
    "range": lambda first, last: list(range(first, min(last, 4096))),
    "rviz_move_groups": rviz_move_groups,
    "rviz_publications": rviz_publications,
    "rviz_subscriptions": rviz_subscriptions,
    "rviz2_markers": rviz2_markers,
    "rviz2_panels": rviz2_panels,
    "rviz2_publications": rviz2_publications,
    "rviz2_subscriptions": rviz2_subscriptions,
    "tree_nodes": tree_nodes,
    "yaml_file": read_yaml_file,
}


_MOVING = frozenset({"revolute", "continuous", "prismatic"})


def joints(description: Value, *, fixed: bool) -> list[dict[str, str]]:
    """Return the `parent` and `child` links of the joints in the text of a description.

    They are those that are fixed, or those that have a position.
    """
    types = frozenset({"fixed"}) if fixed else _MOVING
    is_known = isinstance(description, str) and not isinstance(description, Placeholder)
    found = _read_joints(description) if is_known else ()
    return [{"parent": above, "child": below} for type, above, below in found if type in types]


@lru_cache(maxsize=4)
def _read_joints(description: str) -> tuple[tuple[str, str, str], ...]:
    """Return type, parent and child of each joint; nothing of what cannot be read."""
    try:
        root = parse_element(description, "robot_description")
    except InputError:
        return ()
    return tuple(
        (joint.attributes.get("type", ""), _link(joint, "parent"), _link(joint, "child"))
        for joint in root.elements("joint")
    )


def _link(joint: XmlElement, end: str) -> str:
    found = joint.find(end)
    return found.attributes.get("link", "") if found is not None else ""
