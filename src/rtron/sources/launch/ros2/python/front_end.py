"""Reads a Python launch file: its AST is interpreted until it has described the launch."""

from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Instance,
    ListValue,
    MapValue,
    ModuleValue,
    Native,
    Value,
    truth,
)
from rtron.sources.code.interpreter.execution.abstract_machine import (
    Machine,
    StepsExceededError,
    ThrownError,
)
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.declaration_recorder import Recorder
from rtron.sources.code.interpreter.execution.expressions import EVALUATORS
from rtron.sources.code.interpreter.execution.stack_frame import Frame
from rtron.sources.code.interpreter.execution.statements import EXECUTORS, branch
from rtron.sources.code.interpreter.python.runtime import PythonWorld
from rtron.sources.code.ir import If
from rtron.sources.code.library_models.launch.constructor_calls import LAUNCH_CALLS, launch_context
from rtron.sources.code.library_models.python_std.builtin_functions import BUILTINS
from rtron.sources.code.library_models.python_std.environment import environment
from rtron.sources.code.library_models.python_std.registry import PYTHON_LIBRARY, constants
from rtron.sources.code.workspace_sources import WorkspaceFiles
from rtron.sources.declaration import NodeSite
from rtron.sources.launch.ros2.context_view import View
from rtron.sources.launch.ros2.evaluator import Evaluator
from rtron.sources.launch.ros2.inclusion import Place
from rtron.sources.launch.ros2.launch_context import Scope
from rtron.sources.launch.ros2.python.actions import Actions
from rtron.sources.launch.ros2.python.builders import BUILDERS
from rtron.sources.launch.ros2.python.callbacks import Functions
from rtron.sources.launch.ros2.python.configurations import configurations
from rtron.sources.launch.ros2.python.nav2_common import FILES
from rtron.sources.launch.ros2.python.substitutions import Texts, value_of
from rtron.sources.launch.ros2.python.xacro_module import XacroModule
from rtron.sources.launch.ros2.xml_yaml.element import Element
from rtron.vocabulary import Evidence, Unresolved

_DESCRIBES = ("generate_launch_description", "generate_test_description")
_NATIVES: Mapping[str, Value] = {**PYTHON_LIBRARY, **LAUNCH_CALLS}


@dataclass(frozen=True, slots=True)
class PythonFront:
    """Reads the Python launch files of a workspace; what cannot be read is noted."""

    files: WorkspaceFiles
    evaluator: Evaluator

    @property
    def notes(self) -> list[Unresolved]:
        """The notes of the launch."""
        return self.evaluator.unresolved

    def read(self, path: str) -> Element:
        """Return what a file describes; nothing where it describes nothing."""
        return _File(path, self).root()


@dataclass(frozen=True, slots=True)
class _Launch:
    """The launch as a function of the file sees it."""

    texts: Texts
    view: View

    def perform(self, value: Value) -> Value:
        return value_of(self.view.perform(self.texts.pieces(value)))


@dataclass(slots=True)
class _File:
    path: str
    front: PythonFront
    machine: Machine = field(init=False)
    texts: Texts = field(init=False)

    def root(self) -> Element:
        site = NodeSite(name="/launch", environ=tuple(self.front.evaluator.environ.items()))
        files = self.front.files
        world = PythonWorld(files=files, natives=_NATIVES, builtins=BUILTINS)
        executors: dict[type, Callable[..., str | None]] = {**EXECUTORS, If: _if}
        self.machine = Machine(
            world=world, recorder=Recorder(site), evaluators=dict(EVALUATORS), executors=executors
        )
        world.machine = self.machine
        xacro = XacroModule(self.front.evaluator.commands.output).natives()
        own = {**constants(self.machine), **self._contexts(), **xacro}
        world.natives = {**world.natives, **own}
        count = partial(self.front.evaluator.bounds.piece, self.path)
        self.texts = Texts(self.machine, self._context, FILES, count)
        described = self._described(world)
        actions = Actions(self.texts, Functions(self.texts, self._called), BUILDERS)
        return Element("launch", {}, actions.elements(described))

    def _contexts(self) -> dict[str, Value]:
        """Return the class of contexts; one that a file makes knows nothing of the launch."""

        def make(_: Machine, __: object, arguments: Arguments) -> Value:
            element = Element("launch_context", {}, line=arguments.line)
            scope = Scope(environ=dict(self.front.evaluator.environ))
            return self._context(self.front.evaluator.view(element, scope, Place(self.path, 0)))

        native = Native("LaunchContext", make)
        return dict.fromkeys(
            ("launch.LaunchContext", "launch.launch_context.LaunchContext"), native
        )

    def _described(self, world: PythonWorld) -> Value:
        module = ModuleValue("launch")
        with self._noting():
            module = world.run(Path(self.path), "launch_file")
        for function in (module.fields[name] for name in _DESCRIBES if name in module.fields):
            return _first(self._called(function, Arguments(frame=Frame(file=self.path))))
        self._note("it has no function generate_launch_description")
        return NONE

    def _called(self, function: Value, arguments: Arguments) -> Value:
        with self._noting():
            return dispatch(self.machine, function, arguments)
        return NONE

    def _context(self, view: View) -> Instance:
        known = MapValue(configurations(view.scope))
        seen = environment(self.machine.recorder.site)
        return launch_context(_Launch(self.texts, view), known, seen)

    @contextmanager
    def _noting(self) -> Iterator[None]:
        """Note what ends the program early, and what it leaves open."""
        before = self.machine.spent
        try:
            yield
        except StepsExceededError:
            self._note("too large to be run whole")
        except ThrownError as error:
            self._note(f"{error.name} ends it before all of it is run")
        except RecursionError:
            self._note("nested too deep")
        finally:
            self.front.evaluator.bounds.step(self.path, self.machine.spent - before)
            found = self.machine.recorder.result().unresolved
            self.front.notes.extend(note for note in found if note not in self.front.notes)

    def _note(self, why: str) -> None:
        place = Evidence(file=self.path)
        self.front.notes.append(Unresolved(what=Path(self.path).name, why=why, evidence=(place,)))


def _first(value: Value) -> Value:
    """Return a description without the test's context that may come with it."""
    if isinstance(value, ListValue) and value.kind == "tuple" and value.items:
        return value.items[0]
    return value


def _if(machine: Machine, node: If, frame: Frame) -> str | None:
    """Run an `if`; where it is not decided both sides are read, and that is noted."""
    decided = truth(machine.evaluate(node.test, frame))
    if decided is None:
        place = Evidence(file=frame.file, line=node.line)
        machine.recorder.unresolved("if", "its condition is not known, both sides are read", place)
        return branch(machine, frame, (node.body, node.orelse))
    return machine.execute(node.body if decided else node.orelse, frame)
