"""What a Python launch file made, as elements: one semantics for all three formats."""

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TypeAlias

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.library_models.launch.constructor_calls import (
    ENTITIES_FIELD,
    FILE_FIELD,
    LINE_FIELD,
    constructor_arguments,
    launch_class_name,
)
from rtron.sources.code.library_models.ros1_common.names import abstract_value
from rtron.sources.launch.ros2.context_view import ContextView
from rtron.sources.launch.ros2.launch_context import LaunchVariable
from rtron.sources.launch.ros2.python.substitutions import Fields, SubstitutionTranslator
from rtron.sources.launch.ros2.substitutions.functions import UNKNOWN_COUNT, parse_count, parse_rows
from rtron.sources.launch.ros2.substitutions.template import TemplateText, placeholder
from rtron.sources.launch.ros2.xml_yaml import Element

BuildElements = Callable[[av.Value], tuple[Element, ...]]
ElementCallback = Callable[[ContextView], tuple[Element, ...]]


@dataclass(frozen=True, slots=True)
class LaunchCallbacks:
    """Calls functions of the launch file; `call_function` calls one, and notes what goes wrong."""

    translator: SubstitutionTranslator
    call_function: Callable[[av.Value, Arguments], av.Value]

    def is_function(self, value: av.Value) -> bool:
        """Tell whether a value is a function, not an action or a list of them."""
        return isinstance(value, (av.FunctionValue, av.LibraryFunction))

    def callback(self, fields: Fields, build: BuildElements, *, event: bool) -> ElementCallback:
        """Return what calls `function(context, *args, **kwargs)`, or `function(event, context)`."""

        def run(view: ContextView) -> tuple[Element, ...]:
            context = self.translator.context(view)
            args, _ = av.items_of(fields.get("args", av.NONE))
            first = (av.Unknown("event"), context) if event else (context,)
            kwargs = fields.get("kwargs", av.NONE)
            named = kwargs.entries if isinstance(kwargs, av.MapValue) else {}
            return self._run_function(fields, (*first, *args), named, context, view, build)

        return run

    def loop_callback(self, fields: Fields, build: BuildElements) -> ElementCallback:
        """Return what calls a function for each value of `ForLoop` or `ForEach`."""

        def run(view: ContextView) -> tuple[Element, ...]:
            elements: list[Element] = []
            context = self.translator.context(view)
            for args, named in self._iterations(fields, view):
                elements += self._run_function(fields, args, named, context, view, build)
            return tuple(elements)

        return run

    def _run_function(
        self,
        fields: Fields,
        args: tuple[av.Value, ...],
        named: dict[str, av.Value],
        context: av.Instance,
        view: ContextView,
        build: BuildElements,
    ) -> tuple[Element, ...]:
        function = fields.get("function", av.NONE)
        arguments = Arguments(values=args, keywords=named, frame=StackFrame(file=""))
        before = _known_configurations(context)
        result = self.call_function(function, arguments)
        for name, value in _known_configurations(context).items():
            if before.get(name) != value:
                text = view.perform(self.translator.template(value))
                view.context.set_value(LaunchVariable(str(name)), text)
        return build(result)

    def _iterations(
        self, fields: Fields, view: ContextView
    ) -> Iterable[tuple[tuple[av.Value, ...], dict[str, av.Value]]]:
        if "length" in fields:
            numbers = parse_count(view.perform(self.translator.template(fields["length"])))
            if numbers is None:
                view.note(UNKNOWN_COUNT)
                return [((), {"i": av.Unknown("i")})]
            return [((), {"i": av.Scalar(at)}) for at in numbers]
        rows = parse_rows(view.perform(self.translator.template(fields.get("input_values"))))
        if rows is None:
            view.note(UNKNOWN_COUNT)
            return [((), {})]
        return [((), {key: abstract_value(value) for key, value in row.items()}) for row in rows]


def _known_configurations(context: av.Instance) -> dict[object, av.Value]:
    configurations = context.fields["launch_configurations"]
    return dict(configurations.entries) if isinstance(configurations, av.MapValue) else {}


MAX_DEPTH = 60
Attributes: TypeAlias = dict[str, TemplateText]
Build: TypeAlias = Callable[["ActionTranslator", Fields], Element]

_PROCESSES = frozenset(
    {"Node", "LifecycleNode", "ComposableNodeContainer", "ExecuteProcess", "ExecuteLocal"}
)


@dataclass(slots=True)
class ActionTranslator:
    """Turns actions into elements; `builders` has for each class what makes its element."""

    translator: SubstitutionTranslator
    callbacks: LaunchCallbacks
    builders: Mapping[str, Build]
    _depth: int = 0
    _has_functions: bool = False

    def elements(self, value: av.Value) -> tuple[Element, ...]:
        """Return the elements of an action, of a list of them, or of a launch description."""
        self.translator.count()
        self._depth += 1
        try:
            return tuple(self._elements(value)) if self._depth < MAX_DEPTH else ()
        finally:
            self._depth -= 1

    def function_element(self, run: ElementCallback) -> Element:
        """Return the element of a function that makes actions while the launch is evaluated."""
        self._has_functions = True
        return Element("function", {}, expand=run)

    def _added(self, entities: av.ListValue, count: int) -> Element:
        """Return the element of what functions add to a launch description while it is visited.

        Launch goes on behind the entities that were there, in the description's own scope.
        """

        def expand(_: ContextView) -> tuple[Element, ...]:
            items = entities.items[count:]
            added = tuple(element for item in items for element in self.elements(item))
            return (*added, self._added(entities, count + len(items))) if items else ()

        return Element("function", {}, expand=expand)

    def _elements(self, value: av.Value) -> Iterator[Element]:
        if isinstance(value, av.Choice):
            yield from filter(None, map(self._alternative, value.options))
        elif isinstance(value, av.ListValue):
            for item in value.items:
                yield from self.elements(item)
            yield from [Element("more_actions", {})] if value.open else ()
        elif isinstance(value, av.Instance) and ENTITIES_FIELD in value.fields:
            entities = value.fields[ENTITIES_FIELD]
            yield from self.elements(entities)
            if self._has_functions and isinstance(entities, av.ListValue):
                yield self._added(entities, len(entities.items))
        elif isinstance(value, av.Instance) and launch_class_name(value):
            yield from self._action(value)
        elif value != av.NONE and not _is_of_library(value):
            yield Element("unknown_action", {"name": self.translator.template(value)})

    def _alternative(self, option: av.Value) -> Element | None:
        """Return what is one of several, under a condition that is not known."""
        inner = self.elements(option)
        attributes: Attributes = {"if": (placeholder("one of several"),), "scoped": "false"}
        return Element("group", attributes, inner, line=inner[0].line) if inner else None

    def _action(self, value: av.Instance) -> Iterator[Element]:
        name, fields = launch_class_name(value), constructor_arguments(value)
        build = self.builders.get(name)
        if build is None:
            yield self.with_call_location(Element(name, {}), value)
            return
        element = build(self, fields)
        attributes = {
            **element.attributes,
            **self.condition_attributes(fields.get("condition", av.NONE)),
        }
        yield self.with_call_location(replace(element, attributes=attributes), value)
        if fields.get("on_exit", av.NONE) != av.NONE and name in _PROCESSES:
            yield self.with_call_location(
                self.event_element("OnProcessExit", fields["on_exit"]), value
            )

    def with_call_location(self, element: Element, value: av.Instance) -> Element:
        """Return an element, and those in it without a place, at the place of a call."""
        line, file = (value.fields.get(key, av.NONE) for key in (LINE_FIELD, FILE_FIELD))
        number = line.value if isinstance(line, av.Scalar) else 0
        return element.with_location(number, str(file.value) if isinstance(file, av.Scalar) else "")

    def condition_attributes(self, value: av.Value) -> Attributes:
        """Return what an action's condition says, in the words of XML."""
        return {} if value == av.NONE else {"if": self.translator.template(value)}

    def event_element(self, event: str, value: av.Value) -> Element:
        """Return the element of actions that wait for an event."""
        if self.callbacks.is_function(value):
            run = self.callbacks.callback({"function": value}, self.elements, event=True)
            return Element("event_handler", {"event": event}, (self.function_element(run),))
        return Element("event_handler", {"event": event}, self.elements(value))

    def attributes_of(self, fields: Fields, **keys: str) -> Attributes:
        """Return attributes, each of the parameter that has its name, where that is given."""
        return {
            attribute: self.translator.template(fields[key])
            for attribute, key in keys.items()
            if fields.get(key, av.NONE) != av.NONE
        }

    def pair_elements(self, tag: str, value: av.Value | None, *names: str) -> tuple[Element, ...]:
        """Return an element for each pair of a list, or of a dict."""
        return tuple(
            Element(
                tag,
                {
                    name: self.translator.template(part)
                    for name, part in zip(names, row, strict=False)
                },
            )
            for row in _rows(value)
        )

    def word_elements(self, tag: str, value: av.Value | None) -> tuple[Element, ...]:
        """Return an element for each word of a command line."""
        items, certain = av.items_of(value) if value is not None else ((), True)
        if isinstance(value, (av.Instance, av.Scalar)) and value != av.NONE:
            items, certain = (value,), True
        elements = [Element(tag, {"value": self.translator.template(item)}) for item in items]
        return (*elements, *(() if certain else (Element(tag, {"value": (placeholder("more"),)}),)))


def _is_of_library(value: av.Value) -> bool:
    """Tell whether a value is what a function of Python's library returned: no action."""
    return (
        isinstance(value, av.Unknown) and value.label.partition(".")[0] in sys.stdlib_module_names
    )


def _rows(value: av.Value | None) -> Iterator[tuple[av.Value, ...]]:
    """Yield the pairs of a list or dict; what is not known of them is left out."""
    if isinstance(value, av.MapValue):
        yield from ((av.Scalar(key), inner) for key, inner in value.entries.items())
        return
    for item in av.items_of(value)[0] if value is not None else ():
        for option in av.options(item):
            yield av.items_of(option)[0] if isinstance(option, av.ListValue) else (option,)
