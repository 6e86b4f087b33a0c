"""Parameters that are given another type than their node declares.

Since Galactic a parameter keeps the type of its default, and no value is converted: an integer for
a double throws where the node declares it (docs.ros.org: Notes on statically typed parameters).
"""

import re

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine, ThrownError
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.interpreter.execution.exceptions import is_caught
from rtron.sources.code.library_models.ros2_common.nodes import node_name
from rtron.sources.code.library_models.ros2_common.parameter_types import type_name
from rtron.sources.code.library_models.ros2_common.parameters import (
    AUTOMATIC_FIELD,
    is_declared,
    knows_all_overrides,
    override_value,
)
from rtron.sources.declaration import MistypedParameter

_THROWN = ThrownError("InvalidParameterTypeException", has_unknown_bases=True)
_PERHAPS_NO_TEXT = re.compile(
    r"|[-+.~\d].*|[yn]|yes|no|on|off|true|false", re.IGNORECASE | re.DOTALL
)
"""What libraries for YAML and rcl's parser may take for a text or for a number or a bool."""


def record_mistyped(
    machine: AbstractMachine, node: av.Value, arguments: Arguments, declared: str
) -> None:
    """Record a parameter whose given value throws where `declare_parameter(name, …)` is called.

    A type that is not known on either side says nothing, nor does a call that may ignore the value
    or take any type, nor one whose exception is caught.
    """
    name = arguments.value(0, "name")
    owner = node_name(node)
    if not (declared and isinstance(name, av.Scalar) and isinstance(owner, av.Scalar)):
        return
    given = _given_type(machine, node, name)
    if (
        given in {"", declared}
        or not _is_typed(arguments)
        or is_caught(machine.active_handlers, _THROWN)
    ):
        return
    machine.recorder.add_mistyped(
        MistypedParameter(
            node=str(owner.value),
            name=str(name.value),
            declared_type=declared,
            given_type=given,
            evidence=arguments.evidence,
        )
    )


def _given_type(machine: AbstractMachine, node: av.Value, name: av.Scalar) -> str:
    """Return the type of what certainly overrides the default; empty if nothing is sure to."""
    is_automatic = (
        isinstance(node, av.Instance) and node.fields.get(AUTOMATIC_FIELD, av.FALSE) != av.FALSE
    )
    if is_automatic or is_declared(machine, node, name) or not knows_all_overrides(machine, node):
        return ""
    value = override_value(machine, node, name)
    is_text = isinstance(value, av.Scalar) and isinstance(value.value, str)
    if is_text and _PERHAPS_NO_TEXT.fullmatch(value.value):  # type: ignore[union-attr]
        return ""
    return type_name(value)


def _is_typed(arguments: Arguments) -> bool:
    """Tell whether a declaration has no descriptor that may ask for any type, and no flags."""
    return len(arguments.values) <= 2 and not arguments.keywords.keys() - {"name", "value"}  # noqa: PLR2004 - a name and a default
