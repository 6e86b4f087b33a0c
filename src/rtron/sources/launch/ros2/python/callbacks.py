"""Functions of a Python launch file that make actions while the launch is evaluated."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from rtron.sources.code.interpreter.abstract_values.items import items_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    FunctionValue,
    Hole,
    Instance,
    Known,
    MapValue,
    Native,
    Value,
)
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.stack_frame import Frame
from rtron.sources.code.library_models.ros1_common.names import value_of
from rtron.sources.launch.ros2.context_view import View
from rtron.sources.launch.ros2.launch_context import Source
from rtron.sources.launch.ros2.python.substitutions import Fields, Texts
from rtron.sources.launch.ros2.substitutions.loops import NOT_KNOWN, numbers_of, rows_of
from rtron.sources.launch.ros2.xml_yaml.element import Element

Make = Callable[[Value], tuple[Element, ...]]
Called = Callable[[View], tuple[Element, ...]]


@dataclass(frozen=True, slots=True)
class Functions:
    """Calls functions of the launch file; `guarded` calls one, and notes what goes wrong."""

    texts: Texts
    guarded: Callable[[Value, Arguments], Value]

    def is_function(self, value: Value) -> bool:
        """Tell whether a value is a function, not an action or a list of them."""
        return isinstance(value, (FunctionValue, Native))

    def called(self, fields: Fields, make: Make, *, event: bool) -> Called:
        """Return what calls `function(context, *args, **kwargs)`, or `function(event, context)`."""

        def run(view: View) -> tuple[Element, ...]:
            context = self.texts.context(view)
            args, _ = items_of(fields.get("args", NONE))
            first = (Hole("event"), context) if event else (context,)
            kwargs = fields.get("kwargs", NONE)
            named = kwargs.entries if isinstance(kwargs, MapValue) else {}
            return self._made(fields, (*first, *args), named, context, view, make)

        return run

    def looped(self, fields: Fields, make: Make) -> Called:
        """Return what calls a function for each value of `ForLoop` or `ForEach`."""

        def run(view: View) -> tuple[Element, ...]:
            found: list[Element] = []
            context = self.texts.context(view)
            for args, named in self._rounds(fields, view):
                found += self._made(fields, args, named, context, view, make)
            return tuple(found)

        return run

    def _made(
        self,
        fields: Fields,
        args: tuple[Value, ...],
        named: dict[str, Value],
        context: Instance,
        view: View,
        make: Make,
    ) -> tuple[Element, ...]:
        function = fields.get("function", NONE)
        arguments = Arguments(values=args, keywords=named, frame=Frame(file=""))
        before = _known(context)
        result = self.guarded(function, arguments)
        for name, value in _known(context).items():
            if before.get(name) != value:
                text = view.perform(self.texts.pieces(value))
                view.scope.put(Source(str(name)), text)
        return make(result)

    def _rounds(
        self, fields: Fields, view: View
    ) -> Iterable[tuple[tuple[Value, ...], dict[str, Value]]]:
        if "length" in fields:
            numbers = numbers_of(view.perform(self.texts.pieces(fields["length"])))
            if numbers is None:
                view.note(NOT_KNOWN)
                return [((), {"i": Hole("i")})]
            return [((), {"i": Known(at)}) for at in numbers]
        rows = rows_of(view.perform(self.texts.pieces(fields.get("input_values"))))
        if rows is None:
            view.note(NOT_KNOWN)
            return [((), {})]
        return [((), {key: value_of(value) for key, value in row.items()}) for row in rows]


def _known(context: Instance) -> dict[object, Value]:
    configurations = context.fields["launch_configurations"]
    return dict(configurations.entries) if isinstance(configurations, MapValue) else {}
