"""Plugins that a node loads, and whose source is not here or not known."""

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.exceptions import is_caught

_THROWN = ("CreateClassException", "PluginlibException", "runtime_error", "exception")


def throw_for_another_base(machine: AbstractMachine, name: av.Value) -> None:
    """Throw what pluginlib throws for a class of another base, if that is caught."""
    thrown, files = ThrownError(*_THROWN), machine.runtime.files
    is_here = isinstance(name, av.Scalar) and files.is_plugin(str(name.value))
    if is_here and is_caught(machine.active_handlers, thrown):
        raise thrown


def note_missing_plugin(machine: AbstractMachine, name: av.Value, at: Arguments) -> None:
    """Note a plugin that is not here, or that only the running app names, and who loads it."""
    node = machine.recorder.site.name
    why = f"{node} loads it, and which one it is, is not known"
    if isinstance(name, av.Scalar):
        why = f"{node} loads it, and its source is not found: give the folder of its source too"
    machine.recorder.add_unresolved(f"plugin {av.text_with_holes(name)}", why, at.evidence)
