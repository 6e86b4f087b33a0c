"""Runs one node's program on the abstract machine, and returns what the node declares."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TypeAlias

from rtron.sources.code import ir
from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.cpp.runtime import CppRuntime
from rtron.sources.code.interpreter.cpp.symbol_table import MAX_FILES, SymbolTable
from rtron.sources.code.interpreter.execution.abstract_machine import (
    AbstractMachine,
    StepsExceededError,
    ThrownError,
)
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.calls import dispatch
from rtron.sources.code.interpreter.execution.declaration_recorder import DeclarationRecorder
from rtron.sources.code.interpreter.execution.expressions import EVALUATORS
from rtron.sources.code.interpreter.execution.language_runtime import LanguageRuntime
from rtron.sources.code.interpreter.execution.source_provider import SourceProvider
from rtron.sources.code.interpreter.execution.stack_frame import StackFrame
from rtron.sources.code.interpreter.execution.statements import EXECUTORS
from rtron.sources.code.interpreter.execution.undo_log import UndoLog
from rtron.sources.code.interpreter.python.runtime import PythonRuntime
from rtron.sources.code.last_message import last_messages
from rtron.sources.code.library_models.common.message_types import (
    OTHER_CPP_CLASSES,
    OTHER_CPP_FUNCTIONS,
)
from rtron.sources.code.library_models.common.navigation_plugins import start_plugin
from rtron.sources.code.library_models.cpp_std.registry import (
    CONSTANTS,
    CPP_STD_CLASSES,
    CPP_STD_FUNCTIONS,
)
from rtron.sources.code.library_models.python_std.builtin_functions import BUILTINS
from rtron.sources.code.library_models.python_std.registry import (
    PYTHON_LIBRARY,
    command_line_value,
    node_constants,
)
from rtron.sources.code.library_models.rclcpp.node import component_options
from rtron.sources.code.library_models.rclcpp.pluginlib import HARDWARE_CALLBACKS, hardware_info
from rtron.sources.code.library_models.rclcpp.registry import (
    RCLCPP_CLASSES,
    RCLCPP_CONSTANTS,
    RCLCPP_FUNCTIONS,
)
from rtron.sources.code.library_models.rclpy.registry import rclpy_library
from rtron.sources.code.library_models.roscpp.plugins import start_nodelet
from rtron.sources.code.library_models.roscpp.registry import ROSCPP_CLASSES, ROSCPP_FUNCTION_VALUES
from rtron.sources.code.library_models.rospy.registry import ROSPY
from rtron.sources.code.message_flow import message_flows
from rtron.sources.code.parameter_reads import mark_parameters_read_once
from rtron.sources.code.reachability import (
    joins_nodes,
    names_written_by_callbacks,
    note_unreached,
    run_frame_users,
    run_pending,
    run_transitions,
)
from rtron.sources.declaration import NodeInterface, NodeSite
from rtron.vocabulary import Evidence, UnresolvedCause

_MISSING_CLASS_REASON = "its class is not in the sources"
FIRMWARE_STARTS = ("setup", "loop", "main", "app_main", "appMain")
"""What Arduino, mbed and STM32, ESP-IDF, and micro-ROS for FreeRTOS begin with."""
_Start: TypeAlias = tuple[str, Callable[[], object]]
"""The file that a program starts in, and what runs it."""


def run_python(
    script: Path, site: NodeSite, files: SourceProvider, function: str = ""
) -> NodeInterface:
    """Return what a Python script declares when it runs as the node at `site`.

    With `function` it is a module of which that function is called (an entry point).
    """

    def run(volatile: frozenset[str]) -> AbstractMachine:
        ros = ROSPY if site.ros == 1 else rclpy_library()
        runtime = PythonRuntime(files=files, library={**ros, **PYTHON_LIBRARY}, builtins=BUILTINS)
        machine = _create_machine(runtime, site, volatile)
        runtime.machine = machine
        runtime.library = {**runtime.library, **node_constants(machine)}
        _run_all(machine, script, lambda: _run_script(runtime, script, function))
        return machine

    return _run_to_fixpoint(run, of_node=True)


def _run_script(runtime: PythonRuntime, script: Path, function: str) -> None:
    if not function:
        runtime.run_module(script, "__main__")
        return
    module = runtime.run_module(script, script.stem)
    called = module.fields.get(function) or av.Unknown(function)
    dispatch(runtime.machine, called, Arguments(frame=StackFrame(file=str(script))))


def run_cpp(sources: tuple[Path, ...], site: NodeSite, files: SourceProvider) -> NodeInterface:
    """Return what the program of these sources declares: from its `main` on."""

    def start(runtime: CppRuntime) -> _Start | None:
        functions = runtime.symbols.functions.get("main", [])
        main = next((function for function in functions if function.body is not None), None)
        if main is None:
            return None
        words = command_line_value(site)
        values = (_argument_count(words), words)
        arguments = Arguments(values=values, line=main.line, frame=StackFrame(file=main.file))
        return main.file, partial(runtime.machine.call, av.FunctionValue(main), arguments)

    missing = ("main", "the sources have no main function")
    return _run_cpp_program(sources, site, files, start, missing, of_node=True)


def run_sketch(sources: tuple[Path, ...], site: NodeSite, files: SourceProvider) -> NodeInterface:
    """Return what firmware declares: its globals, and what its board's framework calls."""

    def start(runtime: CppRuntime) -> _Start | None:
        named = (runtime.symbols.functions.get(name, []) for name in FIRMWARE_STARTS)
        functions = [f for found in named for f in found if f.body is not None]
        run = partial(_call_each, runtime.machine, functions)
        return (functions[0].file, run) if functions else None

    return _run_cpp_program(sources, site, files, start, ("setup", "the firmware has none"))


def _call_each(machine: AbstractMachine, functions: Sequence[ir.Function]) -> None:
    for function in functions:
        at = Arguments(line=function.line, frame=StackFrame(file=function.file))
        machine.call(av.FunctionValue(function), at)


def run_nodelet(
    sources: tuple[Path, ...], cls: str, site: NodeSite, files: SourceProvider
) -> NodeInterface:
    """Return what a nodelet's class declares: made, then its `onInit` run."""
    missing = (f"nodelet {cls}", _MISSING_CLASS_REASON)
    return _run_cpp_program(sources, site, files, _class_start(cls, _load_nodelet), missing)


def run_component(
    sources: tuple[Path, ...],
    cls: str,
    site: NodeSite,
    files: SourceProvider,
    other_components: tuple[str, ...] = (),
) -> NodeInterface:
    """Return what a component's class declares: made with the options of a launch (ROS 2).

    Functions of `other_components` that nothing calls are not noted.
    """
    start = _class_start(cls, partial(_make_component, site))
    missing = (f"component {cls}", _MISSING_CLASS_REASON)
    return _run_cpp_program(sources, site, files, start, missing, other_components, of_node=True)


def run_hardware(
    sources: tuple[Path, ...],
    cls: str,
    site: NodeSite,
    files: SourceProvider,
    other_components: tuple[str, ...] = (),
) -> NodeInterface:
    """Return what a hardware component of ros2_control declares: made, then configured."""
    start = _class_start(cls, partial(_load_hardware, site))
    missing = (f"hardware {cls}", _MISSING_CLASS_REASON)
    return _run_cpp_program(sources, site, files, start, missing, other_components)


def run_plugin(
    sources: tuple[Path, ...],
    cls: str,
    site: NodeSite,
    files: SourceProvider,
    other_components: tuple[str, ...] = (),
) -> NodeInterface:
    """Return what a plugin declares that a node loads: made, then started as its base says."""
    start = _class_start(cls, _load_plugin)
    missing = (f"plugin {cls}", _MISSING_CLASS_REASON)
    return _run_cpp_program(sources, site, files, start, missing, other_components)


def _class_start(
    cls: str, run: Callable[[CppRuntime, av.ClassValue], object]
) -> Callable[[CppRuntime], _Start | None]:
    def start(runtime: CppRuntime) -> _Start | None:
        found = runtime.class_named(cls)
        return (found.definition.file, partial(run, runtime, found)) if found else None

    return start


def _run_cpp_program(
    sources: tuple[Path, ...],
    site: NodeSite,
    files: SourceProvider,
    start: Callable[[CppRuntime], _Start | None],
    missing: tuple[str, str],
    other_components: tuple[str, ...] = (),
    *,
    of_node: bool = False,
) -> NodeInterface:
    """Run a program from where it starts; without a start, what is missing is noted."""

    def run(volatile: frozenset[str]) -> AbstractMachine:
        runtime, machine = _create_cpp_machine(sources, site, files, volatile)
        found = start(runtime)
        if found is None:
            location = Evidence(file=str(sources[0]) if sources else "")
            machine.recorder.add_unresolved(*missing, location, cause=UnresolvedCause.MISSING_CODE)
            _note_problems(machine, runtime.symbols, may_join=False)
        else:
            _run_part(machine, Path(found[0]), runtime.initialise_globals)
            _run_all(machine, Path(found[0]), found[1])
        return machine

    return _run_to_fixpoint(run, other_components, of_node=of_node)


def _make_component(site: NodeSite, runtime: CppRuntime, cls: av.ClassValue) -> None:
    frame, line = StackFrame(file=cls.definition.file), cls.definition.line
    given = Arguments(values=(component_options(site),), line=line, frame=frame)
    runtime.instantiate(cls, given)


def _argument_count(words: av.ListValue) -> av.Value:
    return av.Unknown("argc") if words.open else av.Scalar(len(words.items))


def _load_nodelet(runtime: CppRuntime, cls: av.ClassValue) -> None:
    at = Arguments(frame=StackFrame(file=cls.definition.file))
    start_nodelet(runtime.machine, runtime.instantiate(cls, at), at)


def _load_hardware(site: NodeSite, runtime: CppRuntime, cls: av.ClassValue) -> None:
    frame = StackFrame(file=cls.definition.file)
    made = runtime.instantiate(cls, Arguments(frame=frame))
    for callback in HARDWARE_CALLBACKS:
        method = runtime.attribute(made, callback, ())
        given = Arguments(values=(hardware_info(site),), frame=frame)
        dispatch(runtime.machine, method or av.Unknown(callback), given)


def _load_plugin(runtime: CppRuntime, cls: av.ClassValue) -> None:
    at = Arguments(line=cls.definition.line, frame=StackFrame(file=cls.definition.file))
    start_plugin(runtime.machine, runtime.instantiate(cls, at), at)


def _run_to_fixpoint(
    run: Callable[[frozenset[str]], AbstractMachine],
    other_components: tuple[str, ...] = (),
    *,
    of_node: bool = False,
) -> NodeInterface:
    """Run a program, and once more with what its callbacks change taken as unknown.

    In ROS 2 these run when the node is spun: what they change is unknown then, not before. That of
    a node is called by nobody else, so that all it reads of its parameters is seen.
    """
    machine = run(frozenset())
    if machine.recorder.site.ros == 1 and (volatile := names_written_by_callbacks(machine)):
        machine = run(volatile)
    functions = machine.runtime.program_functions()
    own = ((n, f) for n, f in functions if f.name.rpartition("::")[0] not in other_components)
    note_unreached(machine, own)
    interface = machine.recorder.result()
    interface = mark_parameters_read_once(machine, interface) if of_node else interface
    last, flows = tuple(last_messages(machine)), tuple(message_flows(machine))
    run_frame_users(machine)
    frame_uses = machine.recorder.result().frame_uses
    return replace(interface, frame_uses=frame_uses, last_messages=last, message_flows=flows)


def _create_cpp_machine(
    sources: tuple[Path, ...], site: NodeSite, files: SourceProvider, volatile: frozenset[str]
) -> tuple[CppRuntime, AbstractMachine]:
    ros2 = site.ros > 1
    symbols = SymbolTable(files, sources)
    for source in sources:
        symbols.load(source)
    runtime = CppRuntime(
        files=files,
        symbols=symbols,
        library_functions={
            **CPP_STD_FUNCTIONS,
            **OTHER_CPP_FUNCTIONS[site.ros],
            **(RCLCPP_FUNCTIONS if ros2 else ROSCPP_FUNCTION_VALUES),
        },
        library_classes={
            **CPP_STD_CLASSES,
            **OTHER_CPP_CLASSES[site.ros],
            **(RCLCPP_CLASSES if ros2 else ROSCPP_CLASSES),
        },
        library_constants={**CONSTANTS, **(RCLCPP_CONSTANTS if ros2 else {})},
    )
    machine = _create_machine(runtime, site, volatile)
    runtime.machine = machine
    _note_problems(machine, symbols, may_join=True)
    _note_unread(machine, symbols)
    return runtime, machine


def _note_problems(machine: AbstractMachine, symbols: SymbolTable, *, may_join: bool) -> None:
    """Note what cannot be read: what may join nodes, or, where no program was found, the rest."""
    for path, unit in symbols.units.items():
        for problem in unit.problems if symbols.is_program_file(str(path)) else ():
            if problem.may_join is may_join:
                machine.recorder.add_problem(path, problem)


def _note_unread(machine: AbstractMachine, symbols: SymbolTable) -> None:
    """Note the files that are too many, and macros of headers that are not expanded."""
    for path in symbols.unread[:1]:
        why = f"not read: the program has more than {MAX_FILES} files"
        machine.recorder.add_problem(path, ir.SourceProblem(0, why))
    for path, line, name, header in symbols.unexpanded_macros():
        why = f"{name} makes endpoints by a macro of {header.name}, which is not expanded here"
        machine.recorder.add_problem(path, ir.SourceProblem(line, why))


def _create_machine(
    runtime: LanguageRuntime, site: NodeSite, volatile: frozenset[str]
) -> AbstractMachine:
    return AbstractMachine(
        runtime=runtime,
        recorder=DeclarationRecorder(site),
        evaluators=dict(EVALUATORS),
        executors=dict(EXECUTORS),
        volatile=volatile,
        is_relevant=joins_nodes,
        undo_log=UndoLog(elementwise=site.ros > 1),
    )


def _run_all(machine: AbstractMachine, path: Path, run: Callable[[], object]) -> None:
    """Run a program and what it leaves to be called; what does not end is noted."""
    _run_part(machine, path, run)
    if machine.recorder.site.ros > 1:
        _run_part(machine, path, partial(run_transitions, machine))
        machine.volatile = names_written_by_callbacks(machine)
        machine.recorder.is_spinning = True
    _run_part(machine, path, partial(run_pending, machine))


def _run_part(machine: AbstractMachine, path: Path, run: Callable[[], object]) -> None:
    try:
        run()
    except StepsExceededError as error:
        machine.recorder.add_too_large(path.name, error.place or Evidence(file=str(path)))
    except ThrownError as error:
        _note_incomplete(
            machine, path, f"{error.name} ends it before all of it is run", error.place
        )
    except RecursionError:
        _note_incomplete(machine, path, "nested too deep")


def _note_incomplete(
    machine: AbstractMachine, path: Path, why: str, place: Evidence | None = None
) -> None:
    machine.recorder.add_partly_read(path.name, why, place or Evidence(file=str(path)))
