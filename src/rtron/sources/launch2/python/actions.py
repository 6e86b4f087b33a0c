"""Actions of a Python launch file as elements, one semantics for all three formats."""

import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import TypeAlias

from rtron.sources.code.interpreter.items import items_of
from rtron.sources.code.interpreter.values import (
    NONE,
    Choice,
    ClassValue,
    FunctionValue,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    Native,
    Value,
    options,
)
from rtron.sources.code.natives.launch_calls import (
    ENTITIES,
    FILE,
    LINE,
    call_name,
    given,
)
from rtron.sources.launch2.element import Element
from rtron.sources.launch2.pieces import Call, Pieces, Written, hole
from rtron.sources.launch2.python.functions import Functions
from rtron.sources.launch2.python.parameters import entries, parameter, parameters
from rtron.sources.launch2.python.texts import Fields, Texts, plain_text, says_no

MAX_DEPTH = 60
Attributes: TypeAlias = dict[str, Written]


@dataclass(slots=True)
class Actions:
    """Turns what a launch file made into elements."""

    texts: Texts
    functions: Functions
    _depth: int = 0

    def elements(self, value: Value) -> tuple[Element, ...]:
        """Return the elements of an action, of a list of them, or of a launch description."""
        self._depth += 1
        try:
            return tuple(self._elements(value)) if self._depth < MAX_DEPTH else ()
        finally:
            self._depth -= 1

    def _elements(self, value: Value) -> Iterator[Element]:
        if isinstance(value, Choice):
            for option in value.options:
                inner = self.elements(option)
                unsure: Attributes = {"if": (hole("one of several"),), "scoped": "false"}
                line = inner[0].line if inner else 0
                yield from [Element("group", unsure, inner, line=line)] if inner else ()
        elif isinstance(value, ListValue):
            for item in value.items:
                yield from self.elements(item)
            if value.open:
                yield Element("more_actions", {})
        elif isinstance(value, Instance) and ENTITIES in value.fields:
            yield from self.elements(value.fields[ENTITIES])
        elif isinstance(value, Instance) and call_name(value):
            yield from self._action(value)
        elif value != NONE and not _is_of_library(value):
            yield Element("unknown_action", {"name": self.texts.pieces(value)})

    def _action(self, value: Instance) -> Iterator[Element]:
        name, fields = call_name(value), given(value)
        build = _BUILDERS.get(name)
        if build is None:
            yield self._at(Element(name, {}), value)
            return
        made = build(self, fields)
        attributes = {**made.attributes, **self._condition(fields.get("condition", NONE))}
        yield self._at(replace(made, attributes=attributes), value)
        if fields.get("on_exit", NONE) != NONE and name in _PROCESSES:
            yield self._at(self._event("OnProcessExit", fields["on_exit"]), value)

    def _at(self, element: Element, value: Instance) -> Element:
        """Return an element, and those in it without a place, at the place of a call."""
        line, file = (value.fields.get(key, NONE) for key in (LINE, FILE))
        at = line.value if isinstance(line, Known) else 0
        return _placed(element, at, str(file.value) if isinstance(file, Known) else "")

    def _condition(self, value: Value) -> Attributes:
        name = call_name(value)
        if value == NONE:
            return {}
        if name == "UnlessCondition":
            return {"unless": self.texts.pieces(given(value)["predicate_expression"])}  # type: ignore[arg-type]
        if name == "LaunchConfigurationNotEquals":
            return {"unless": (self._equals(value),)}
        if name == "LaunchConfigurationEquals":
            return {"if": (self._equals(value),)}
        return {"if": self.texts.pieces(value)}

    def _equals(self, value: Value) -> Call:
        fields = given(value) if isinstance(value, Instance) else {}
        keys = ("launch_configuration_name", "expected_value")
        return Call("config-equals", tuple(self.texts.pieces(fields.get(key)) for key in keys))

    def texts_of(self, fields: Fields, **keys: str) -> Attributes:
        """Return attributes, each of the parameter that has its name, where that is given."""
        return {
            attribute: self.texts.pieces(fields[key])
            for attribute, key in keys.items()
            if fields.get(key, NONE) != NONE
        }

    def pairs(self, tag: str, value: Value | None, *names: str) -> tuple[Element, ...]:
        """Return an element for each pair of a list, or of a dict."""
        rows = _rows(value)
        return tuple(
            Element(
                tag,
                {name: self.texts.pieces(part) for name, part in zip(names, row, strict=False)},
            )
            for row in rows
        )

    def words(self, tag: str, value: Value | None) -> tuple[Element, ...]:
        """Return an element for each word of a command line."""
        items, certain = items_of(value) if value is not None else ((), True)
        if isinstance(value, (Instance, Known)) and value != NONE:
            items, certain = (value,), True
        found = [Element(tag, {"value": self.texts.pieces(item)}) for item in items]
        return (*found, *(() if certain else (Element(tag, {"value": (hole("more"),)}),)))

    def node(self, fields: Fields, tag: str) -> Element:
        """Return a node's element."""
        fields = {_OLD.get(key, key): value for key, value in fields.items()}
        attributes = self.texts_of(
            fields, pkg="package", exec="executable", name="name", namespace="namespace"
        )
        children = (
            *self.words("args", fields.get("arguments")),
            *self.words("ros_args", fields.get("ros_arguments")),
            *self._given(fields),
            *self.pairs("env", fields.get("env"), "name", "value"),
            *self.pairs("env", fields.get("additional_env"), "name", "value"),
            *self.components(fields),
        )
        return Element(tag, attributes, children)

    def _given(self, fields: Fields) -> tuple[Element, ...]:
        return (
            *self.pairs("remap", fields.get("remappings"), "from", "to"),
            *parameters(self.texts, fields.get("parameters"), 0, ""),
        )

    def components(self, fields: Fields) -> Iterator[Element]:
        """Yield the components that are to be loaded."""
        items, certain = items_of(fields.get("composable_node_descriptions", NONE))
        for item in (option for item in items for option in options(item)):
            if isinstance(item, Instance) and call_name(item):
                yield self._at(self._component(given(item)), item)
            else:
                yield Element("composable_node", {"plugin": self.texts.pieces(item)})
        if not certain:
            yield Element("composable_node", {"plugin": (hole("more components"),)})

    def _component(self, fields: Fields) -> Element:
        fields = {_OLD.get(key, key): value for key, value in fields.items()}
        attributes = self.texts_of(
            fields, pkg="package", plugin="plugin", name="name", namespace="namespace"
        )
        items, _ = items_of(fields.get("extra_arguments", NONE))
        extra = [
            element
            for item in items
            if isinstance(item, MapValue)
            for element in entries(self.texts, item, 0, "", "extra_arg")
        ]
        attributes |= self._condition(fields.get("condition", NONE))
        return Element("composable_node", attributes, (*self._given(fields), *extra))

    def load(self, fields: Fields) -> Element:
        """Return the element of an action that loads components."""
        target = fields.get("target_container", NONE)
        text = self.texts.pieces(target)
        if isinstance(target, Instance) and call_name(target) == "ComposableNodeContainer":
            own = given(target)
            keys = [key for key in ("name", "namespace") if own.get(key, NONE) != NONE]
            text = (Call("node-name", tuple(self.texts.pieces(own[key]) for key in keys)),)
        return Element("load_composable_node", {"target": text}, tuple(self.components(fields)))

    def group(self, fields: Fields) -> Element:
        """Return a group's element."""
        flags: Attributes = {
            key: "false" for key in ("scoped", "forwarding") if says_no(fields.get(key))
        }
        keep = self.pairs("keep", fields.get("launch_configurations"), "name", "value")
        return Element("group", flags, (*keep, *self.elements(fields.get("actions", NONE))))

    def include(self, fields: Fields) -> Element:
        """Return the element of an inclusion."""
        file = self.texts.pieces(fields.get("launch_description_source"))
        given = self.pairs("arg", fields.get("launch_arguments"), "name", "value")
        return Element("include", {"file": file}, given)

    def argument(self, fields: Fields) -> Element:
        """Return the element of a declared argument."""
        attributes = self.texts_of(fields, name="name", default="default_value")
        attributes["description"] = plain_text(fields.get("description"))
        return Element("arg", attributes)

    def shared(self, fields: Fields) -> Element:
        """Return the element of a parameter for all nodes."""
        name: Pieces = self.texts.pieces(fields.get("name")) or ("use_sim_time",)
        return parameter(self.texts, name, fields.get("value", NONE), 0, "", "set_parameter")

    def timer(self, fields: Fields) -> Element:
        """Return the element of what runs later."""
        attributes = self.texts_of(fields, period="period")
        return Element("timer", attributes, self.elements(fields.get("actions", NONE)))

    def handler(self, fields: Fields) -> Element:
        """Return the element of what runs on an event."""
        handler = fields.get("event_handler", NONE)
        if not isinstance(handler, Instance) or not call_name(handler):
            return Element("unknown_handler", {})
        found = [value for key, value in given(handler).items() if key in _ON]
        inner = [self._event(call_name(handler), value) for value in found]
        children = tuple(child for one in inner for child in one.children)
        return Element("event_handler", {"event": call_name(handler)}, children)

    def _event(self, event: str, value: Value) -> Element:
        if isinstance(value, (FunctionValue, Native)):
            children = (self.function({"function": value}, event=True),)
        else:
            children = self.elements(value)
        return Element("event_handler", {"event": event}, children)

    def function(self, fields: Fields, *, event: bool = False) -> Element:
        """Return the element of a function that makes actions when it is called."""
        call = self.functions.called(fields, self.elements, event=event)
        return Element("function", {}, run=call)

    def loop(self, fields: Fields) -> Element:
        """Return the element of a function that makes actions for each of some values."""
        return Element("function", {}, run=self.functions.looped(fields, self.elements))


def _is_of_library(value: Value) -> bool:
    """Tell whether a value is what a function of Python's library returned: no action."""
    return isinstance(value, Hole) and value.why.partition(".")[0] in sys.stdlib_module_names


def _placed(element: Element, line: int, file: str) -> Element:
    children = tuple(_placed(child, line, file) for child in element.children)
    return replace(element, children=children, line=element.line or line, file=element.file or file)


def _rows(value: Value | None) -> Iterator[tuple[Value, ...]]:
    """Yield the pairs of a list or dict; what is not known of them is left out."""
    if isinstance(value, MapValue):
        yield from ((Known(key), inner) for key, inner in value.entries.items())
        return
    for item in items_of(value)[0] if value is not None else ():
        for option in options(item):
            parts, _ = items_of(option) if isinstance(option, ListValue) else ((option,), True)
            yield parts


def _plain(tag: str, **keys: str) -> "Callable[[Actions, Fields], Element]":
    return lambda actions, fields: Element(tag, actions.texts_of(fields, **keys))


def _process(actions: Actions, fields: Fields) -> Element:
    description = fields.get("process_description", NONE)
    own = given(description) if isinstance(description, Instance) else fields
    environ = (
        *actions.pairs("env", own.get("env"), "name", "value"),
        *actions.pairs("env", own.get("additional_env"), "name", "value"),
    )
    name = actions.texts_of(own, name="name")
    return Element("executable", name, (*actions.words("cmd", own.get("cmd")), *environ))


def _reset(actions: Actions, fields: Fields) -> Element:
    kept = actions.pairs("keep", fields.get("launch_configurations"), "name", "value")
    return Element("reset", {}, kept)


_OLD = {
    "node_executable": "executable",
    "node_name": "name",
    "node_namespace": "namespace",
    "node_plugin": "plugin",
}
_ON = frozenset(
    {
        "on_exit",
        "on_start",
        "on_completion",
        "on_shutdown",
        "on_stdin",
        "on_stdout",
        "on_stderr",
        "on_event",
        "entities",
        "handler",
    }
)
_PROCESSES = frozenset(
    {"Node", "LifecycleNode", "ComposableNodeContainer", "ExecuteProcess", "ExecuteLocal"}
)
_SILENT = (
    "EmitEvent",
    "LifecycleTransition",
    "Log",
    "LogDebug",
    "LogError",
    "LogInfo",
    "LogWarning",
    "ReadyToTest",
    "SetROSLogDir",
    "Shutdown",
    "UnregisterEventHandler",
)
_BUILDERS: Mapping[str, Callable[[Actions, Fields], Element]] = {
    **dict.fromkeys(_SILENT, lambda actions, fields: Element("log", {})),
    "AppendEnvironmentVariable": _plain(
        "append_env", name="name", value="value", prepend="prepend", separator="separator"
    ),
    "ComposableNodeContainer": lambda actions, fields: actions.node(fields, "node_container"),
    "DeclareLaunchArgument": Actions.argument,
    "ExecuteLocal": _process,
    "ExecuteProcess": _process,
    "ForEach": Actions.loop,
    "ForLoop": Actions.loop,
    "GroupAction": Actions.group,
    "IncludeLaunchDescription": Actions.include,
    "LifecycleNode": lambda actions, fields: actions.node(fields, "lifecycle_node"),
    "LoadComposableNodes": Actions.load,
    "Node": lambda actions, fields: actions.node(fields, "node"),
    "OpaqueCoroutine": Actions.function,
    "OpaqueFunction": Actions.function,
    "PushROSNamespace": _plain("push_ros_namespace", namespace="namespace"),
    "PushRosNamespace": _plain("push_ros_namespace", namespace="namespace"),
    "RegisterEventHandler": Actions.handler,
    "ResetEnvironment": lambda actions, fields: Element("reset_env", {}),
    "ResetLaunchConfigurations": _reset,
    "RosTimer": Actions.timer,
    "SetEnvironmentVariable": _plain("set_env", name="name", value="value"),
    "SetLaunchConfiguration": _plain("let", name="name", value="value"),
    "SetParameter": Actions.shared,
    "SetParametersFromFile": _plain("set_parameters_from_file", filename="filename"),
    "SetRemap": _plain("set_remap", **{"from": "src", "to": "dst"}),
    "SetUseSimTime": Actions.shared,
    "TimerAction": Actions.timer,
    "UnsetLaunchConfiguration": _plain("unset", name="name"),
    "UnsetEnvironmentVariable": _plain("unset_env", name="name"),
}
