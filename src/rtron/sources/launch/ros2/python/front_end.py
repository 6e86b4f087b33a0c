"""Reads a Python launch file: its AST is interpreted until it has described the launch."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import (
    AbstractMachine,
    StepsExceededError,
    ThrownError,
)
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.declaration_recorder import DeclarationRecorder
from rtron.sources.code.interpreter.execution.expressions import EVALUATORS
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.interpreter.execution.statements import EXECUTORS, run_both_sides
from rtron.sources.code.interpreter.python.runtime import PythonRuntime
from rtron.sources.code.ir import If
from rtron.sources.code.library_models.launch.constructor_calls import (
    LAUNCH_FUNCTIONS,
    launch_context,
)
from rtron.sources.code.library_models.python_std.builtin_functions import BUILTINS
from rtron.sources.code.library_models.python_std.environment import environment_value
from rtron.sources.code.library_models.python_std.registry import PYTHON_LIBRARY, node_constants
from rtron.sources.code.library_models.ros1_common.names import abstract_value as parameter_value
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeSite
from rtron.sources.launch.ros2.context_view import ContextView
from rtron.sources.launch.ros2.element_site import ElementSite, FileInclusion
from rtron.sources.launch.ros2.evaluator import LaunchEvaluator
from rtron.sources.launch.ros2.launch_context import LaunchContext
from rtron.sources.launch.ros2.parameters.merge import ParameterSource
from rtron.sources.launch.ros2.python.actions import ActionTranslator, LaunchCallbacks
from rtron.sources.launch.ros2.python.builders import BUILDERS
from rtron.sources.launch.ros2.python.nav2_common import FILE_SUBSTITUTIONS
from rtron.sources.launch.ros2.python.substitutions import SubstitutionTranslator, value_of
from rtron.sources.launch.ros2.python.xacro_module import XacroModule
from rtron.sources.launch.ros2.substitutions.template import display_text
from rtron.sources.launch.ros2.xml_yaml import Element
from rtron.vocabulary import Evidence, UnresolvedCause, UnresolvedItem

GLOBAL_PARAMETERS_KEY, REMAPS_KEY = "global_params", "ros_remaps"
"""The names under which launch_ros keeps what SetParameter and SetRemap set."""


def context_configurations(context: LaunchContext) -> dict[object, av.Value]:
    """Return what a context has as `launch_configurations`."""
    values: dict[object, av.Value] = {
        name: value_of(text) for name, text in context.configurations.items()
    }
    values |= {
        variable.name: av.Unknown(variable.name)
        for variable in context.unknown
        if not variable.is_environment
    }
    if context.parameters is not None:
        pairs = [pair for source in context.parameters for pair in _parameter_pairs(source)]
        values[GLOBAL_PARAMETERS_KEY] = av.list_of(pairs)
    if context.remaps is not None:
        values[REMAPS_KEY] = av.list_of(
            [_pair(value_of(a), value_of(b)) for a, b in context.remaps]
        )
    return values


def _parameter_pairs(source: ParameterSource) -> Iterator[av.Value]:
    """Yield a file's name, or a name with its value."""
    if source.file:
        yield value_of(source.file)
        return
    for _, values in source.entries:
        for name, parameter in values.items():
            yield _pair(av.Scalar(name), parameter_value(parameter.value, name))


def _pair(first: av.Value, second: av.Value) -> av.Value:
    return av.list_of([first, second], "tuple")


_ENTRY_FUNCTIONS = ("generate_launch_description", "generate_test_description")
_LIBRARY_MODELS: Mapping[str, av.Value] = {**PYTHON_LIBRARY, **LAUNCH_FUNCTIONS}


@dataclass(frozen=True, slots=True)
class PythonFrontEnd:
    """Reads the Python launch files of a workspace; what cannot be read is noted."""

    files: WorkspaceSources
    evaluator: LaunchEvaluator

    @property
    def unresolved(self) -> list[UnresolvedItem]:
        """The notes of the launch."""
        return self.evaluator.unresolved

    def read(self, path: str) -> Element:
        """Return what a file describes; nothing where it describes nothing."""
        return _PythonLaunchFile(path, self).root()


@dataclass(frozen=True, slots=True)
class _LaunchSession:
    """The launch as a function of the file sees it."""

    translator: SubstitutionTranslator
    view: ContextView

    def perform(self, value: av.Value) -> av.Value:
        return value_of(self.view.perform(self.translator.template(value)))


@dataclass(slots=True)
class _PythonLaunchFile:
    path: str
    front_end: PythonFrontEnd
    machine: AbstractMachine = field(init=False)
    translator: SubstitutionTranslator = field(init=False)

    def root(self) -> Element:
        site = NodeSite(name="/launch", environ=tuple(self.front_end.evaluator.environ.items()))
        files = self.front_end.files
        world = PythonRuntime(files=files, library=_LIBRARY_MODELS, builtins=BUILTINS)
        executors: dict[type, Callable[..., str | None]] = {**EXECUTORS, If: _execute_if}
        self.machine = AbstractMachine(
            runtime=world,
            recorder=DeclarationRecorder(site),
            evaluators=dict(EVALUATORS),
            executors=executors,
        )
        world.machine = self.machine
        xacro = XacroModule(
            self.front_end.evaluator.command_output.output_of_command
        ).library_models()
        file_models = {**node_constants(self.machine), **self._context_classes(), **xacro}
        world.library = {**world.library, **file_models}
        count = partial(self.front_end.evaluator.limits.count_text_part, self.path)
        self.translator = SubstitutionTranslator(
            self.machine, self._context, FILE_SUBSTITUTIONS, count
        )
        described = self._description(world)
        actions = ActionTranslator(
            self.translator, LaunchCallbacks(self.translator, self._call), BUILDERS
        )
        return Element("launch", {}, actions.elements(described))

    def _context_classes(self) -> dict[str, av.Value]:
        """Return the class of contexts; one that a file makes knows nothing of the launch."""

        def make(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
            element = Element("launch_context", {}, line=arguments.line)
            context = LaunchContext(environ=dict(self.front_end.evaluator.environ))
            site = ElementSite(element, context, FileInclusion(self.path, 0))
            return self._context(self.front_end.evaluator.context_view(site))

        native = av.LibraryFunction("LaunchContext", make)
        return dict.fromkeys(
            ("launch.LaunchContext", "launch.launch_context.LaunchContext"), native
        )

    def _description(self, world: PythonRuntime) -> av.Value:
        module = av.ModuleValue("launch")
        with self._collect_errors():
            module = world.run_module(Path(self.path), "launch_file")
        for name in _ENTRY_FUNCTIONS:
            if name in module.fields:
                return self._described_by(module.fields[name], name)
        self._note(f"it has no function {_ENTRY_FUNCTIONS[0]}")
        return av.NONE

    def _described_by(self, function: av.Value, name: str) -> av.Value:
        notes = len(self.front_end.unresolved)
        found = self._call(function, Arguments(frame=StackFrame(file=self.path)))
        if found == av.NONE and len(self.front_end.unresolved) == notes:
            self._note(f"its {name}() returns nothing")
        return _without_test_context(found)

    def _call(self, function: av.Value, arguments: Arguments) -> av.Value:
        with self._collect_errors():
            return dispatch(self.machine, function, arguments)
        return av.NONE

    def _context(self, view: ContextView) -> av.Instance:
        known_configurations = av.MapValue(context_configurations(view.context))
        environment = environment_value(self.machine.recorder.site)
        return launch_context(
            _LaunchSession(self.translator, view), known_configurations, environment
        )

    @contextmanager
    def _collect_errors(self) -> Iterator[None]:
        """Note what ends the program early, and what it leaves open."""
        before = self.machine.steps_taken
        try:
            yield
        except StepsExceededError:
            self._note("too large to be run whole")
        except ThrownError as error:
            self._note(f"{error.name} ends it before all of it is run")
        except RecursionError:
            self._note("nested too deep")
        finally:
            self.front_end.evaluator.limits.count_steps(
                self.path, self.machine.steps_taken - before
            )
            found = self.machine.recorder.result().unresolved
            notes = (replace(note, what=display_text(note.what)) for note in found)
            self.front_end.unresolved.extend(
                note for note in notes if note not in self.front_end.unresolved
            )

    def _note(self, why: str) -> None:
        what, evidence = Path(self.path).name, (Evidence(file=self.path),)
        note = UnresolvedItem(
            what=what, why=why, cause=UnresolvedCause.PARTLY_READ, evidence=evidence
        )
        self.front_end.unresolved.append(note)


def _without_test_context(value: av.Value) -> av.Value:
    """Return a description without the test's context that may come with it."""
    if isinstance(value, av.ListValue) and value.kind == "tuple" and value.items:
        return value.items[0]
    return value


def _execute_if(machine: AbstractMachine, node: If, frame: StackFrame) -> str | None:
    """Run an `if`; where it is not decided both sides are read, and that is noted."""
    decided = av.truth(machine.evaluate(node.test, frame))
    if decided is None:
        location = Evidence(file=frame.file, line=node.line)
        machine.recorder.add_unresolved(
            "if", "its condition is not known, both sides are read", location
        )
        return run_both_sides(machine, node, frame)
    return machine.execute(node.body if decided else node.orelse, frame)
