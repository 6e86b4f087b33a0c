"""rclpy.qos_overriding_options (github.com/ros2/rclpy@9.1.2)."""

from collections.abc import Mapping

from rtron.sources.code.interpreter.abstract_values.value_types import (
    LibraryClass,
    Scalar,
    Unknown,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common import qos_overrides


def _make_overriding_options(_: AbstractMachine, arguments: Arguments) -> Value:
    """`QoSOverridingOptions(policy_kinds, callback=…, entity_id=…)`."""
    policies = arguments.get(0, "policy_kinds") or Unknown("policy_kinds")
    return qos_overrides.overriding_options(_OVERRIDING_OPTIONS, policies, _entity_id(arguments))


def _with_default_policies(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`QoSOverridingOptions.with_default_policies(callback=…, entity_id=…)`."""
    return qos_overrides.with_default_policies(_OVERRIDING_OPTIONS, _entity_id(arguments))


def _entity_id(arguments: Arguments) -> Value | None:
    found = arguments.keywords.get("entity_id")
    return None if found == Scalar(None) else found


_OVERRIDING_OPTIONS = LibraryClass(
    "rclpy.qos_overriding_options.QoSOverridingOptions",
    _make_overriding_options,
    {"with_default_policies": _with_default_policies},
)
OVERRIDING_CLASSES: Mapping[str, Value] = {
    _OVERRIDING_OPTIONS.name: _OVERRIDING_OPTIONS,
    **{
        f"rclpy.qos.QoSPolicyKind.{kind.upper()}": Scalar(kind)
        for kind in qos_overrides.POLICY_KINDS
    },
}
