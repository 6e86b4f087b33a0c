"""rosidl_runtime_py.utilities: interfaces by their full names."""

from collections.abc import Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    LibraryFunction,
    MessageType,
    Scalar,
    Unknown,
    Value,
    map_options,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments

_PARTS = 3
_FOLDERS = {
    "get_message": {"msg"},
    "get_service": {"srv"},
    "get_action": {"action"},
    "get_interface": {"msg", "srv", "action"},
}


def _get_interface(
    folders: set[str], _: AbstractMachine, __: object, arguments: Arguments
) -> Value:
    """`get_message("std_msgs/msg/String")`."""

    def named(value: Value) -> Value:
        name = value.value if isinstance(value, Scalar) else None
        parts = name.split("/") if isinstance(name, str) else []
        is_full = len(parts) == _PARTS and all(parts) and parts[1] in folders
        return MessageType("/".join(parts)) if is_full else Unknown("interface")

    return map_options(arguments.get(0, "identifier") or Unknown("?"), named)


ROSIDL: Mapping[str, Value] = {
    f"rosidl_runtime_py.utilities.{name}": LibraryFunction(name, partial(_get_interface, folders))
    for name, folders in _FOLDERS.items()
}
