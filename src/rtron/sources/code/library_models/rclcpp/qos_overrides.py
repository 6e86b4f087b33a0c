"""rclcpp's options of publishers and subscriptions (rclcpp: qos_overriding_options.hpp)."""

from collections.abc import Callable, Mapping, Sequence

from rtron.sources.code.interpreter.abstract_values.items import listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Instance,
    Known,
    ListValue,
    NativeClass,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common import qos_overrides

_FIELD = "qos_overriding_options"
_ID_AT = 2
_NAMES = ("PublisherOptions", "SubscriptionOptions")


def options_among(arguments: Arguments) -> Value | None:
    """Return the options of overriding among what an endpoint is made with."""
    for value in arguments.values[1:]:
        if isinstance(value, Instance) and _FIELD in value.fields:
            given = value.fields[_FIELD]
            return _made(given.items) if isinstance(given, ListValue) else given
    return None


def _options(_: Machine, arguments: Arguments) -> Value:
    """`rclcpp::PublisherOptions()`, or a copy of others."""
    before = next((v.fields for v in arguments.values if isinstance(v, Instance)), {})
    return Instance(OPTIONS, {_FIELD: NONE, **before})


def _overriding(_: Machine, arguments: Arguments) -> Value:
    """`QosOverridingOptions({QosPolicyKind::Depth, …}, callback, id)`, or the policies alone."""
    return _made(arguments.values)


def _made(values: Sequence[Value]) -> Value:
    first = values[0] if values else listed(())
    if isinstance(first, Instance) and qos_overrides.POLICIES in first.fields:
        return first
    if not isinstance(first, ListValue):
        return qos_overrides.overriding(_OVERRIDING, listed(tuple(values)), None)
    identity = values[_ID_AT] if len(values) > _ID_AT else None
    return qos_overrides.overriding(_OVERRIDING, first, identity)


def _by_default(_: Machine, __: object, arguments: Arguments) -> Value:
    """`QosOverridingOptions::with_default_policies(callback, id)`."""
    return qos_overrides.with_default_policies(_OVERRIDING, arguments.get(1))


OPTIONS = NativeClass("rclcpp::PublisherOptions", _options)
_OVERRIDING = NativeClass("rclcpp::QosOverridingOptions", _overriding)
OVERRIDING_CLASSES: Mapping[str, NativeClass] = {
    **{f"rclcpp::{name}{more}": OPTIONS for name in _NAMES for more in ("", "WithAllocator")},
    "rclcpp::QosOverridingOptions": _OVERRIDING,
}
OVERRIDING_FUNCTIONS: Mapping[str, Callable[..., Value]] = {
    "rclcpp::QosOverridingOptions::with_default_policies": _by_default
}
OVERRIDING_CONSTANTS: Mapping[str, Value] = {
    f"rclcpp::QosPolicyKind::{kind.title().replace('_', '')}": Known(kind)
    for kind in qos_overrides.KINDS
}
