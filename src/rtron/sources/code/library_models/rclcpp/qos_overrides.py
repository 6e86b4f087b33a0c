"""rclcpp's options of publishers and subscriptions (rclcpp: qos_overriding_options.hpp)."""

from collections.abc import Callable, Mapping, Sequence

from rtron.sources.code.interpreter.abstract_values.items import list_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Instance,
    LibraryClass,
    ListValue,
    Scalar,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common import qos_overrides

_FIELD = "qos_overriding_options"
_ID_AT = 2
_NAMES = ("PublisherOptions", "SubscriptionOptions")


def overriding_options_argument(arguments: Arguments) -> Value | None:
    """Return the options of overriding among what an endpoint is made with."""
    for value in arguments.values[1:]:
        if isinstance(value, Instance) and _FIELD in value.fields:
            given = value.fields[_FIELD]
            return _overriding_options(given.items) if isinstance(given, ListValue) else given
    return None


def _make_endpoint_options(_: AbstractMachine, arguments: Arguments) -> Value:
    """`rclcpp::PublisherOptions()`, or a copy of others."""
    before = next((v.fields for v in arguments.values if isinstance(v, Instance)), {})
    return Instance(ENDPOINT_OPTIONS, {_FIELD: NONE, **before})


def _make_overriding_options(_: AbstractMachine, arguments: Arguments) -> Value:
    """`QosOverridingOptions({QosPolicyKind::Depth, …}, callback, id)`, or the policies alone."""
    return _overriding_options(arguments.values)


def _overriding_options(values: Sequence[Value]) -> Value:
    first = values[0] if values else list_of(())
    if isinstance(first, Instance) and qos_overrides.POLICIES_FIELD in first.fields:
        return first
    if not isinstance(first, ListValue):
        return qos_overrides.overriding_options(_OVERRIDING, list_of(tuple(values)), None)
    identity = values[_ID_AT] if len(values) > _ID_AT else None
    return qos_overrides.overriding_options(_OVERRIDING, first, identity)


def _with_default_policies(_: AbstractMachine, __: object, arguments: Arguments) -> Value:
    """`QosOverridingOptions::with_default_policies(callback, id)`."""
    return qos_overrides.with_default_policies(_OVERRIDING, arguments.get(1))


ENDPOINT_OPTIONS = LibraryClass("rclcpp::PublisherOptions", _make_endpoint_options)
_OVERRIDING = LibraryClass("rclcpp::QosOverridingOptions", _make_overriding_options)
OVERRIDING_CLASSES: Mapping[str, LibraryClass] = {
    **{
        f"rclcpp::{name}{more}": ENDPOINT_OPTIONS
        for name in _NAMES
        for more in ("", "WithAllocator")
    },
    "rclcpp::QosOverridingOptions": _OVERRIDING,
}
OVERRIDING_FUNCTIONS: Mapping[str, Callable[..., Value]] = {
    "rclcpp::QosOverridingOptions::with_default_policies": _with_default_policies
}
OVERRIDING_CONSTANTS: Mapping[str, Value] = {
    f"rclcpp::QosPolicyKind::{kind.title().replace('_', '')}": Scalar(kind)
    for kind in qos_overrides.POLICY_KINDS
}
