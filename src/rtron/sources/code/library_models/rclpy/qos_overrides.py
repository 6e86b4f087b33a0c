"""rclpy.qos_overriding_options (github.com/ros2/rclpy@9.1.2)."""

from collections.abc import Mapping

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Hole,
    Known,
    NativeClass,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common import qos_overrides


def _make(_: Machine, arguments: Arguments) -> Value:
    """`QoSOverridingOptions(policy_kinds, callback=…, entity_id=…)`."""
    policies = arguments.get(0, "policy_kinds") or Hole("policy_kinds")
    return qos_overrides.overriding(_CLASS, policies, _identity(arguments))


def _by_default(_: Machine, __: object, arguments: Arguments) -> Value:
    """`QoSOverridingOptions.with_default_policies(callback=…, entity_id=…)`."""
    return qos_overrides.with_default_policies(_CLASS, _identity(arguments))


def _identity(arguments: Arguments) -> Value | None:
    found = arguments.keywords.get("entity_id")
    return None if found == Known(None) else found


_CLASS = NativeClass(
    "rclpy.qos_overriding_options.QoSOverridingOptions",
    _make,
    {"with_default_policies": _by_default},
)
OVERRIDING: Mapping[str, Value] = {
    _CLASS.name: _CLASS,
    **{f"rclpy.qos.QoSPolicyKind.{kind.upper()}": Known(kind) for kind in qos_overrides.KINDS},
}
