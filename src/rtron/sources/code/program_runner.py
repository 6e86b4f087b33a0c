"""Runs one node's program on the abstract machine, and returns what the node declares."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

from rtron.sources.code.interpreter.abstract_values.value_types import (
    ClassValue,
    FunctionValue,
    Hole,
    Known,
    ListValue,
    Value,
)
from rtron.sources.code.interpreter.cpp.runtime import CppWorld
from rtron.sources.code.interpreter.cpp.symbol_table import Symbols
from rtron.sources.code.interpreter.execution.abstract_machine import (
    Machine,
    StepsExceededError,
    ThrownError,
)
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.declaration_recorder import Recorder
from rtron.sources.code.interpreter.execution.expressions import EVALUATORS
from rtron.sources.code.interpreter.execution.language_runtime import World
from rtron.sources.code.interpreter.execution.source_provider import Files
from rtron.sources.code.interpreter.execution.stack_frame import Frame
from rtron.sources.code.interpreter.execution.statements import EXECUTORS
from rtron.sources.code.interpreter.execution.undo_log import Trail
from rtron.sources.code.interpreter.python.runtime import PythonWorld
from rtron.sources.code.ir import Problem
from rtron.sources.code.library_models.cpp_std.registry import (
    CONSTANTS,
    CPP_STD_CLASSES,
    CPP_STD_FUNCTIONS,
)
from rtron.sources.code.library_models.python_std.builtin_functions import BUILTINS
from rtron.sources.code.library_models.python_std.registry import (
    PYTHON_LIBRARY,
    command_line,
    constants,
)
from rtron.sources.code.library_models.rclcpp.node import loading_options
from rtron.sources.code.library_models.rclcpp.registry import (
    RCLCPP_CLASSES,
    RCLCPP_CONSTANTS,
    RCLCPP_FUNCTIONS,
)
from rtron.sources.code.library_models.rclpy.registry import rclpy_natives
from rtron.sources.code.library_models.roscpp.classes import CPP_ROS_CLASSES, CPP_ROS_FUNCTIONS
from rtron.sources.code.library_models.rospy.registry import PYTHON_ROS
from rtron.sources.code.reachability import (
    changed_at_any_time,
    joins_nodes,
    run_pending,
    run_transitions,
)
from rtron.sources.code.unreached import JOINS, note_unreached
from rtron.sources.declaration import NodeInterface, NodeSite
from rtron.vocabulary import Evidence

_PIECE = "cannot be read: "


def run_python(script: Path, site: NodeSite, files: Files, function: str = "") -> NodeInterface:
    """Return what a Python script declares when it runs as the node at `site`.

    With `function` it is a module of which that function is called (an entry point).
    """

    def run(volatile: frozenset[str]) -> Machine:
        ros = PYTHON_ROS if site.ros == 1 else rclpy_natives()
        world = PythonWorld(files=files, natives={**ros, **PYTHON_LIBRARY}, builtins=BUILTINS)
        machine = _machine(world, site, volatile)
        world.machine = machine
        world.natives = {**world.natives, **constants(machine)}
        _bounded(machine, script, lambda: _run_script(world, script, function))
        return machine

    return _settled(run)


def _run_script(world: PythonWorld, script: Path, function: str) -> None:
    if not function:
        world.run(script, "__main__")
        return
    module = world.run(script, script.stem)
    called = module.fields.get(function) or Hole(function)
    dispatch(world.machine, called, Arguments(frame=Frame(file=str(script))))


def run_cpp(sources: tuple[Path, ...], site: NodeSite, files: Files) -> NodeInterface:
    """Return what the program of these sources declares: from its `main` on."""

    def run(volatile: frozenset[str]) -> Machine:
        world, machine = _cpp(sources, site, files, volatile)
        mains = [f for f in world.symbols.functions.get("main", []) if f.body is not None]
        if not mains:
            place = Evidence(file=str(sources[0]) if sources else "")
            machine.recorder.unresolved("main", "the sources have no main function", place)
        for main in mains[:1]:
            words = command_line(site)
            values = (_count(words), words)
            arguments = Arguments(values=values, line=main.line, frame=Frame(file=main.file))
            called = FunctionValue(main)
            _part(machine, Path(main.file), world.make_globals)
            _bounded(machine, Path(main.file), partial(machine.call, called, arguments))
        return machine

    return _settled(run)


def run_nodelet(sources: tuple[Path, ...], cls: str, site: NodeSite, files: Files) -> NodeInterface:
    """Return what a nodelet's class declares: made, then its `onInit` run."""

    def run(volatile: frozenset[str]) -> Machine:
        world, machine = _cpp(sources, site, files, volatile)
        found = world.class_named(cls)
        if found is None:
            place = Evidence(file=str(sources[0]) if sources else "")
            machine.recorder.unresolved(f"nodelet {cls}", "its class is not in the sources", place)
        else:
            _part(machine, Path(found.definition.file), world.make_globals)
            _bounded(machine, Path(found.definition.file), partial(_load, world, found))
        return machine

    return _settled(run)


def run_component(
    sources: tuple[Path, ...],
    cls: str,
    site: NodeSite,
    files: Files,
    beside: tuple[str, ...] = (),
) -> NodeInterface:
    """Return what a component's class declares: made with the options of a launch (ROS 2).

    What the components `beside` it join is not missed.
    """

    def run(volatile: frozenset[str]) -> Machine:
        world, machine = _cpp(sources, site, files, volatile)
        found = world.class_named(cls)
        if found is None:
            place = Evidence(file=str(sources[0]) if sources else "")
            machine.recorder.unresolved(
                f"component {cls}", "its class is not in the sources", place
            )
        else:
            frame = Frame(file=found.definition.file)
            given = Arguments(
                values=(loading_options(site),), line=found.definition.line, frame=frame
            )
            _part(machine, Path(frame.file), world.make_globals)
            _bounded(machine, Path(frame.file), partial(world.instantiate, found, given))
        return machine

    return _settled(run, beside)


def _count(words: ListValue) -> Value:
    return Hole("argc") if words.open else Known(len(words.items))


def _load(world: CppWorld, cls: ClassValue) -> None:
    frame = Frame(file=cls.definition.file)
    made = world.instantiate(cls, Arguments(frame=frame))
    method = world.attribute(made, "onInit", ())
    dispatch(world.machine, method or Hole("onInit"), Arguments(frame=frame))


def _settled(
    run: Callable[[frozenset[str]], Machine], beside: tuple[str, ...] = ()
) -> NodeInterface:
    """Run a program, and once more with what its callbacks change taken as unknown.

    In ROS 2 these run when the node is spun: what they change is unknown then, not before.
    """
    machine = run(frozenset())
    volatile = changed_at_any_time(machine) if machine.recorder.site.ros == 1 else frozenset()
    settled = run(volatile) if volatile else machine
    functions = settled.world.own_functions()
    ours = [(name, f) for name, f in functions if f.name.rpartition("::")[0] not in beside]
    note_unreached(settled, ours)
    return settled.recorder.result()


def _cpp(
    sources: tuple[Path, ...], site: NodeSite, files: Files, volatile: frozenset[str]
) -> tuple[CppWorld, Machine]:
    ros2 = site.ros > 1
    symbols = Symbols(files, sources, everywhere=ros2)
    for source in sources:
        symbols.load(source)
    world = CppWorld(
        files=files,
        symbols=symbols,
        functions={**CPP_STD_FUNCTIONS, **(RCLCPP_FUNCTIONS if ros2 else CPP_ROS_FUNCTIONS)},
        native_classes={**CPP_STD_CLASSES, **(RCLCPP_CLASSES if ros2 else CPP_ROS_CLASSES)},
        constants={**CONSTANTS, **(RCLCPP_CONSTANTS if ros2 else {})},
    )
    machine = _machine(world, site, volatile)
    world.machine = machine
    for source in sources:
        for problem in symbols.units[source].problems if source in symbols.units else ():
            if _matters(problem):
                machine.recorder.problem(source, problem)
    return world, machine


def _matters(problem: Problem) -> bool:
    """Tell whether a problem is of a whole file, or of a piece that may join nodes."""
    return _PIECE not in problem.why or any(word in problem.why for word in JOINS)


def _machine(world: World, site: NodeSite, volatile: frozenset[str]) -> Machine:
    return Machine(
        world=world,
        recorder=Recorder(site),
        evaluators=dict(EVALUATORS),
        executors=dict(EXECUTORS),
        volatile=volatile,
        matters=joins_nodes,
        trail=Trail(elementwise=site.ros > 1),
    )


def _bounded(machine: Machine, path: Path, run: Callable[[], object]) -> None:
    """Run a program and what it leaves to be called; what does not end is noted."""
    _part(machine, path, run)
    if machine.recorder.site.ros > 1:
        _part(machine, path, partial(run_transitions, machine))
        machine.volatile = changed_at_any_time(machine)
        machine.recorder.spun = True
    _part(machine, path, partial(run_pending, machine))


def _part(machine: Machine, path: Path, run: Callable[[], object]) -> None:
    try:
        run()
    except StepsExceededError:
        _incomplete(machine, path, "too large to be run whole")
    except ThrownError as error:
        _incomplete(machine, path, f"{error.name} ends it before all of it is run")
    except RecursionError:
        _incomplete(machine, path, "nested too deep")


def _incomplete(machine: Machine, path: Path, why: str) -> None:
    machine.recorder.unresolved(path.name, why, Evidence(file=str(path)))
