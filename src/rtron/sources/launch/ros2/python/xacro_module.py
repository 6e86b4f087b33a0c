"""The module `xacro` as Python launch files use it: `xacro.process_file(path).toxml()`.

Source: the docstrings of xacro (ROS 2). Nothing is run: RTron's own evaluator describes the robot.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Instance,
    LibraryClass,
    LibraryFunction,
    MapValue,
    Scalar,
    Unknown,
    Value,
    plain,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.launch.common.commands import XacroCommand
from rtron.sources.launch.common.errors import UnresolvableError

DescribeXacro: TypeAlias = Callable[[XacroCommand], str]
"""Returns a robot's description; raises UnresolvableError where that is not known."""
_TEXT_FIELD = "text"


def _text(_: AbstractMachine, owner: Instance, __: Arguments) -> Value:
    return owner.fields[_TEXT_FIELD]


_DOCUMENT = LibraryClass("xacro.Document", methods=dict.fromkeys(("toxml", "toprettyxml"), _text))


@dataclass(frozen=True, slots=True)
class XacroModule:
    """The functions of xacro that give a description."""

    describe: DescribeXacro

    def library_models(self) -> dict[str, Value]:
        """Return the functions by their names."""
        return {
            "xacro.process": LibraryFunction("process", self._process),
            "xacro.process_file": LibraryFunction("process_file", self._process_file),
        }

    def _process_file(self, machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
        return Instance(_DOCUMENT, {_TEXT_FIELD: self._process(machine, None, arguments)})

    def _process(self, machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
        file = arguments.get(0, "input_file_name") or NONE
        mappings = _mappings(arguments.keywords.get("mappings", NONE))
        if not isinstance(file, Scalar) or mappings is None:
            return Unknown(f"xacro {text_with_holes(file)}")
        try:
            return Scalar(self.describe(XacroCommand(file=plain(file.value), mappings=mappings)))
        except UnresolvableError as error:
            machine.recorder.add_unresolved("xacro", str(error), arguments.evidence)
            return Unknown(f"xacro {plain(file.value)}")


def _mappings(value: Value) -> Mapping[str, str] | None:
    """Return the arguments of a description; None where they are not known."""
    if value == NONE:
        return {}
    entries = value.fields if isinstance(value, MapValue) else {None: NONE}
    mappings = {
        plain(key): plain(entry.value)
        for key, entry in entries.items()
        if isinstance(entry, Scalar)
    }
    return mappings if len(mappings) == len(entries) and NONE not in entries.values() else None
