"""Runs one node's program on the abstract machine, and returns what the node declares."""

from pathlib import Path

from rtron.sources.code.interpreter.arguments import Arguments
from rtron.sources.code.interpreter.calling import dispatch
from rtron.sources.code.interpreter.cpp_world import CppWorld
from rtron.sources.code.interpreter.expressions import EVALUATORS
from rtron.sources.code.interpreter.files import Files
from rtron.sources.code.interpreter.frame import Frame
from rtron.sources.code.interpreter.items import listed
from rtron.sources.code.interpreter.machine import Machine, StepsExceededError, ThrownError
from rtron.sources.code.interpreter.python_world import PythonWorld
from rtron.sources.code.interpreter.recorder import Recorder
from rtron.sources.code.interpreter.statements import EXECUTORS
from rtron.sources.code.interpreter.symbols import Symbols
from rtron.sources.code.interpreter.values import FunctionValue, Hole, Known
from rtron.sources.code.interpreter.world import World
from rtron.sources.code.natives.cpp_ros import CPP_ROS_CLASSES, CPP_ROS_FUNCTIONS
from rtron.sources.code.natives.cpp_std import CPP_STD_CLASSES, CPP_STD_FUNCTIONS
from rtron.sources.code.natives.python_builtins import BUILTINS
from rtron.sources.code.natives.python_library import PYTHON_LIBRARY, constants
from rtron.sources.code.natives.python_ros import PYTHON_ROS
from rtron.sources.code.reachability import run_pending
from rtron.sources.declaration import NodeInterface, NodeSite
from rtron.vocabulary import Evidence


def run_python(script: Path, site: NodeSite, files: Files) -> NodeInterface:
    """Return what a Python script declares when it runs as the node at `site`."""
    recorder = Recorder(site)
    world = PythonWorld(files=files, natives={**PYTHON_ROS, **PYTHON_LIBRARY}, builtins=BUILTINS)
    machine = _machine(world, recorder)
    world.machine = machine
    world.natives = {**world.natives, **constants(machine)}
    _bounded(machine, script, lambda: world.run(script, "__main__"))
    return recorder.result()


def run_cpp(sources: tuple[Path, ...], site: NodeSite, files: Files) -> NodeInterface:
    """Return what the program of these sources declares: from its `main` on."""
    world, machine = _cpp(sources, site, files)
    mains = [f for f in world.symbols.functions.get("main", []) if f.body is not None]
    if not mains:
        place = Evidence(file=str(sources[0]) if sources else "")
        machine.recorder.unresolved("main", "the sources have no main function", place)
    for main in mains[:1]:
        words = (site.name.rpartition("/")[2], *site.args)
        values = (Known(len(words)), listed([Known(word) for word in words]))
        arguments = Arguments(values=values, line=main.line, frame=Frame(file=main.file))
        _bounded(machine, Path(main.file), lambda: machine.call(FunctionValue(main), arguments))
    return machine.recorder.result()


def run_nodelet(
    sources: tuple[Path, ...], cls: str, site: NodeSite, files: Files
) -> NodeInterface:
    """Return what a nodelet's class declares: made, then its `onInit` run."""
    world, machine = _cpp(sources, site, files)
    found = world.class_named(cls)
    if found is None:
        place = Evidence(file=str(sources[0]) if sources else "")
        machine.recorder.unresolved(f"nodelet {cls}", "its class is not in the sources", place)
        return machine.recorder.result()

    def load() -> None:
        frame = Frame(file=found.definition.file)
        made = world.instantiate(found, Arguments(frame=frame))
        method = world.attribute(made, "onInit", ())
        dispatch(machine, method or Hole("onInit"), Arguments(frame=frame))

    _bounded(machine, Path(found.definition.file), load)
    return machine.recorder.result()


def _cpp(
    sources: tuple[Path, ...], site: NodeSite, files: Files
) -> tuple[CppWorld, Machine]:
    symbols = Symbols(files)
    for source in sources:
        symbols.load(source)
    world = CppWorld(
        files=files,
        symbols=symbols,
        functions={**CPP_STD_FUNCTIONS, **CPP_ROS_FUNCTIONS},
        native_classes={**CPP_STD_CLASSES, **CPP_ROS_CLASSES},
    )
    machine = _machine(world, Recorder(site))
    world.machine = machine
    return world, machine


def _machine(world: World, recorder: Recorder) -> Machine:
    return Machine(
        world=world, recorder=recorder, evaluators=dict(EVALUATORS), executors=dict(EXECUTORS)
    )


def _bounded(machine: Machine, path: Path, run: object) -> None:
    """Run a program and what it leaves to be called; what does not end is noted."""
    try:
        run()  # type: ignore[operator]
        run_pending(machine)
    except StepsExceededError:
        machine.recorder.unresolved(path.name, "too large to be run whole", Evidence(file=str(path)))
    except ThrownError as error:
        machine.recorder.unresolved(path.name, f"ends by {error.name}", Evidence(file=str(path)))
    except RecursionError:
        machine.recorder.unresolved(path.name, "nested too deep", Evidence(file=str(path)))
