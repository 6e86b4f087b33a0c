"""Functions of a Python launch file that make actions while the launch is evaluated."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.library_models.ros1_common.names import abstract_value
from rtron.sources.launch.ros2.context_view import ContextView
from rtron.sources.launch.ros2.launch_context import LaunchVariable
from rtron.sources.launch.ros2.python.substitutions import Fields, SubstitutionTranslator
from rtron.sources.launch.ros2.substitutions.loops import UNKNOWN_COUNT, parse_count, parse_rows
from rtron.sources.launch.ros2.xml_yaml.element import Element

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
