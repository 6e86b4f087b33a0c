"""What a Python launch file made, as elements: one semantics for all three formats."""

import sys
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TypeAlias

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Choice,
    Hole,
    Instance,
    Known,
    ListValue,
    MapValue,
    Value,
    options,
)
from rtron.sources.code.library_models.launch.constructor_calls import (
    ENTITIES,
    FILE,
    LINE,
    call_name,
    given,
)
from rtron.sources.launch.ros2.python.callbacks import Functions
from rtron.sources.launch.ros2.python.substitutions import Fields, Texts
from rtron.sources.launch.ros2.substitutions.template import Call, Written, hole
from rtron.sources.launch.ros2.xml_yaml.element import Element

MAX_DEPTH = 60
Attributes: TypeAlias = dict[str, Written]
Build: TypeAlias = Callable[["Actions", Fields], Element]

_PROCESSES = frozenset(
    {"Node", "LifecycleNode", "ComposableNodeContainer", "ExecuteProcess", "ExecuteLocal"}
)


@dataclass(slots=True)
class Actions:
    """Turns actions into elements; `builders` has for each class what makes its element."""

    texts: Texts
    functions: Functions
    builders: Mapping[str, Build]
    _depth: int = 0

    def elements(self, value: Value) -> tuple[Element, ...]:
        """Return the elements of an action, of a list of them, or of a launch description."""
        self.texts.count()
        self._depth += 1
        try:
            return tuple(self._elements(value)) if self._depth < MAX_DEPTH else ()
        finally:
            self._depth -= 1

    def _elements(self, value: Value) -> Iterator[Element]:
        if isinstance(value, Choice):
            yield from filter(None, map(self._unsure, value.options))
        elif isinstance(value, ListValue):
            for item in value.items:
                yield from self.elements(item)
            yield from [Element("more_actions", {})] if value.open else ()
        elif isinstance(value, Instance) and ENTITIES in value.fields:
            yield from self.elements(value.fields[ENTITIES])
        elif isinstance(value, Instance) and call_name(value):
            yield from self._action(value)
        elif value != NONE and not _is_of_library(value):
            yield Element("unknown_action", {"name": self.texts.pieces(value)})

    def _unsure(self, option: Value) -> Element | None:
        """Return what is one of several, under a condition that is not known."""
        inner = self.elements(option)
        unsure: Attributes = {"if": (hole("one of several"),), "scoped": "false"}
        return Element("group", unsure, inner, line=inner[0].line) if inner else None

    def _action(self, value: Instance) -> Iterator[Element]:
        name, fields = call_name(value), given(value)
        build = self.builders.get(name)
        if build is None:
            yield self.at(Element(name, {}), value)
            return
        made = build(self, fields)
        attributes = {**made.attributes, **self.condition(fields.get("condition", NONE))}
        yield self.at(replace(made, attributes=attributes), value)
        if fields.get("on_exit", NONE) != NONE and name in _PROCESSES:
            yield self.at(self.event("OnProcessExit", fields["on_exit"]), value)

    def at(self, element: Element, value: Instance) -> Element:
        """Return an element, and those in it without a place, at the place of a call."""
        line, file = (value.fields.get(key, NONE) for key in (LINE, FILE))
        number = line.value if isinstance(line, Known) else 0
        return element.placed(number, str(file.value) if isinstance(file, Known) else "")

    def condition(self, value: Value) -> Attributes:
        """Return what an action's condition says, in the words of XML."""
        name, fields = call_name(value), given(value) if isinstance(value, Instance) else {}
        if value == NONE:
            return {}
        if name == "UnlessCondition":
            return {"unless": self.texts.pieces(fields.get("predicate_expression"))}
        if name == "LaunchConfigurationNotEquals":
            keys = ("launch_configuration_name", "expected_value")
            words = tuple(self.texts.pieces(fields.get(key)) for key in keys)
            return {"unless": (Call("config-equals", words),)}
        return {"if": self.texts.pieces(value)}

    def event(self, event: str, value: Value) -> Element:
        """Return the element of actions that wait for an event."""
        if self.functions.is_function(value):
            run = self.functions.called({"function": value}, self.elements, event=True)
            return Element("event_handler", {"event": event}, (Element("function", {}, run=run),))
        return Element("event_handler", {"event": event}, self.elements(value))

    def texts_of(self, fields: Fields, **keys: str) -> Attributes:
        """Return attributes, each of the parameter that has its name, where that is given."""
        return {
            attribute: self.texts.pieces(fields[key])
            for attribute, key in keys.items()
            if fields.get(key, NONE) != NONE
        }

    def pairs(self, tag: str, value: Value | None, *names: str) -> tuple[Element, ...]:
        """Return an element for each pair of a list, or of a dict."""
        return tuple(
            Element(
                tag,
                {name: self.texts.pieces(part) for name, part in zip(names, row, strict=False)},
            )
            for row in _rows(value)
        )

    def words(self, tag: str, value: Value | None) -> tuple[Element, ...]:
        """Return an element for each word of a command line."""
        items, certain = items_of(value) if value is not None else ((), True)
        if isinstance(value, (Instance, Known)) and value != NONE:
            items, certain = (value,), True
        found = [Element(tag, {"value": self.texts.pieces(item)}) for item in items]
        return (*found, *(() if certain else (Element(tag, {"value": (hole("more"),)}),)))


def _is_of_library(value: Value) -> bool:
    """Tell whether a value is what a function of Python's library returned: no action."""
    return isinstance(value, Hole) and value.why.partition(".")[0] in sys.stdlib_module_names


def _rows(value: Value | None) -> Iterator[tuple[Value, ...]]:
    """Yield the pairs of a list or dict; what is not known of them is left out."""
    if isinstance(value, MapValue):
        yield from ((Known(key), inner) for key, inner in value.entries.items())
        return
    for item in items_of(value)[0] if value is not None else ():
        for option in options(item):
            yield items_of(option)[0] if isinstance(option, ListValue) else (option,)
