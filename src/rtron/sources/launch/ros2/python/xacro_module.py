"""The module `xacro` as Python launch files use it: `xacro.process_file(path).toxml()`.

Source: the docstrings of xacro (ROS 2). Nothing is run: RTron's own evaluator describes the robot.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.abstract_values.value_types import plain
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.launch.common.commands import XacroCommand
from rtron.sources.launch.common.errors import UnresolvableError

DescribeXacro: TypeAlias = Callable[[XacroCommand], str]
"""Returns a robot's description; raises UnresolvableError where that is not known."""
_TEXT_FIELD = "text"


def _text(_: AbstractMachine, owner: av.Instance, __: Arguments) -> av.Value:
    return owner.fields[_TEXT_FIELD]


_DOCUMENT = av.LibraryClass(
    "xacro.Document", methods=dict.fromkeys(("toxml", "toprettyxml"), _text)
)


@dataclass(frozen=True, slots=True)
class XacroModule:
    """The functions of xacro that give a description."""

    describe: DescribeXacro

    def library_models(self) -> dict[str, av.Value]:
        """Return the functions by their names."""
        return {
            "xacro.process": av.LibraryFunction("process", self._process),
            "xacro.process_file": av.LibraryFunction("process_file", self._process_file),
        }

    def _process_file(self, machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
        return av.Instance(_DOCUMENT, {_TEXT_FIELD: self._process(machine, None, arguments)})

    def _process(self, machine: AbstractMachine, _: object, arguments: Arguments) -> av.Value:
        file = arguments.get(0, "input_file_name") or av.NONE
        mappings = _mappings(arguments.keywords.get("mappings", av.NONE))
        if not isinstance(file, av.Scalar) or mappings is None:
            return av.Unknown(f"xacro {av.text_with_holes(file)}")
        try:
            return av.Scalar(self.describe(XacroCommand(file=plain(file.value), mappings=mappings)))
        except UnresolvableError as error:
            machine.recorder.add_unresolved("xacro", str(error), arguments.evidence)
            return av.Unknown(f"xacro {plain(file.value)}")


def _mappings(value: av.Value) -> Mapping[str, str] | None:
    """Return the arguments of a description; None where they are not known."""
    if value == av.NONE:
        return {}
    entries = value.fields if isinstance(value, av.MapValue) else {None: av.NONE}
    mappings = {
        plain(key): plain(entry.value)
        for key, entry in entries.items()
        if isinstance(entry, av.Scalar)
    }
    return mappings if len(mappings) == len(entries) and av.NONE not in entries.values() else None
