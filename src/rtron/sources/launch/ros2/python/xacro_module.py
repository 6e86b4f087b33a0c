"""The module `xacro` as Python launch files use it: `xacro.process_file(path).toxml()`.

Source: the docstrings of xacro (ROS 2). Nothing is run: RTron's own evaluator describes the robot.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TypeAlias

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Hole,
    Instance,
    Known,
    MapValue,
    Native,
    NativeClass,
    Value,
    plain,
    spelled,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.launch.common.commands import Xacro
from rtron.sources.launch.common.errors import UnresolvableError

Describe: TypeAlias = Callable[[Xacro], str]
"""Returns a robot's description; raises UnresolvableError where that is not known."""
_TEXT = "text"


def _text(_: Machine, owner: Instance, __: Arguments) -> Value:
    return owner.fields[_TEXT]


_DOCUMENT = NativeClass("xacro.Document", methods=dict.fromkeys(("toxml", "toprettyxml"), _text))


@dataclass(frozen=True, slots=True)
class XacroModule:
    """The functions of xacro that give a description."""

    describe: Describe

    def natives(self) -> dict[str, Value]:
        """Return the functions by their names."""
        return {
            "xacro.process": Native("process", self._process),
            "xacro.process_file": Native("process_file", self._process_file),
        }

    def _process_file(self, machine: Machine, _: object, arguments: Arguments) -> Value:
        return Instance(_DOCUMENT, {_TEXT: self._process(machine, None, arguments)})

    def _process(self, machine: Machine, _: object, arguments: Arguments) -> Value:
        file = arguments.get(0, "input_file_name") or NONE
        mappings = _mappings(arguments.keywords.get("mappings", NONE))
        if not isinstance(file, Known) or mappings is None:
            return Hole(f"xacro {spelled(file)}")
        try:
            return Known(self.describe(Xacro(file=plain(file.value), mappings=mappings)))
        except UnresolvableError as error:
            machine.recorder.unresolved("xacro", str(error), arguments.evidence)
            return Hole(f"xacro {plain(file.value)}")


def _mappings(value: Value) -> Mapping[str, str] | None:
    """Return the arguments of a description; None where they are not known."""
    if value == NONE:
        return {}
    entries = value.fields if isinstance(value, MapValue) else {None: NONE}
    found = {plain(key): plain(one.value) for key, one in entries.items() if isinstance(one, Known)}
    return found if len(found) == len(entries) and NONE not in entries.values() else None
