"""rclcpp::QoS and the classes around it (rclcpp/qos.hpp)."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.trivial_functions import (
    return_argument,
    return_owner,
    returning_field,
)
from rtron.sources.code.library_models.ros2_common.qos import (
    DEFAULT_QOS,
    DEPTH_FIELD,
    DURABILITY_FIELD,
    POLICIES_FIELD,
    POLICY_KINDS,
    QOS_PROFILES,
    RELIABILITY_FIELD,
    is_qos,
    overriding_options,
    policy_value,
    qos_fields,
    qos_object,
    with_default_policies,
)
from rtron.vocabulary import Durability, Reliability


def _make_profile(name: str, machine: AbstractMachine, arguments: Arguments) -> av.Value:
    """Make a profile: `rclcpp::QoS(10)`, `QoS(KeepLast(10))`, `SensorDataQoS()`."""
    del machine
    new = qos_object(QOS, QOS_PROFILES[name])
    for value in arguments.values:
        if isinstance(value, av.Instance) and is_qos(value):
            new.fields.update({key: value.fields[key] for key in qos_fields(DEFAULT_QOS)})
        elif isinstance(value, av.Instance) and DEPTH_FIELD in value.fields:
            new.fields[DEPTH_FIELD] = value.fields[DEPTH_FIELD]
        elif isinstance(value, av.Scalar) and isinstance(value.value, int):
            new.fields[DEPTH_FIELD] = value
    return new


def _make_initialization(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`rclcpp::KeepLast(n)`, `rclcpp::KeepAll()`."""
    return av.Instance(_INITIALIZATION, {DEPTH_FIELD: arguments.get(0) or av.Scalar(0)})


def _set_policy(
    field: str, value: av.Value, machine: AbstractMachine, owner: av.Instance, _: Arguments
) -> av.Value:
    machine.undo_log.set(owner.fields, field, value)
    return owner


def _set_policy_argument(
    field: str, machine: AbstractMachine, owner: av.Instance, arguments: Arguments
) -> av.Value:
    given = arguments.get(0)
    value = given if field == DEPTH_FIELD and given is not None else policy_value(given)
    machine.undo_log.set(owner.fields, field, value)
    return owner


_POLICIES: Mapping[str, tuple[str, av.Value]] = {
    "reliable": (RELIABILITY_FIELD, av.Scalar(Reliability.RELIABLE.value)),
    "best_effort": (RELIABILITY_FIELD, av.Scalar(Reliability.BEST_EFFORT.value)),
    "reliability_best_available": (RELIABILITY_FIELD, av.Unknown("best available")),
    "transient_local": (DURABILITY_FIELD, av.Scalar(Durability.TRANSIENT_LOCAL.value)),
    "durability_volatile": (DURABILITY_FIELD, av.Scalar(Durability.VOLATILE.value)),
    "durability_best_available": (DURABILITY_FIELD, av.Unknown("best available")),
    "keep_all": (DEPTH_FIELD, av.Scalar(0)),
}
_METHODS: Mapping[str, Callable[..., av.Value]] = {
    **{name: partial(_set_policy, *policy) for name, policy in _POLICIES.items()},
    "reliability": partial(_set_policy_argument, RELIABILITY_FIELD),
    "durability": partial(_set_policy_argument, DURABILITY_FIELD),
    "keep_last": partial(_set_policy_argument, DEPTH_FIELD),
    "depth": returning_field(DEPTH_FIELD),
    **dict.fromkeys(
        (
            *("deadline", "lifespan", "liveliness", "liveliness_lease_duration", "history"),
            *("avoid_ros_namespace_conventions", "get_rmw_qos_profile"),
        ),
        return_owner,
    ),
}
QOS = av.LibraryClass("rclcpp::QoS", partial(_make_profile, "default"), dict(_METHODS))
_INITIALIZATION = av.LibraryClass("rclcpp::QoSInitialization", _make_initialization)
_PROFILE_CLASSES = {
    "SensorDataQoS": "sensor_data",
    "ServicesQoS": "services_default",
    "ParametersQoS": "parameters",
    "ParameterEventsQoS": "parameter_events",
    "ClockQoS": "clock",
    "RosoutQoS": "rosout",
    "SystemDefaultsQoS": "system_default",
}

QOS_CLASSES: Mapping[str, av.LibraryClass] = {
    "rclcpp::QoS": QOS,
    **{
        f"rclcpp::{name}": av.LibraryClass(
            f"rclcpp::{name}", partial(_make_profile, profile), QOS.methods
        )
        for name, profile in _PROFILE_CLASSES.items()
    },
    **dict.fromkeys(
        ("rclcpp::KeepLast", "rclcpp::KeepAll", "rclcpp::QoSInitialization"), _INITIALIZATION
    ),
}
QOS_FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {
    "rclcpp::QoSInitialization::from_rmw": return_argument
}
QOS_CONSTANTS: Mapping[str, av.Value] = {
    f"rmw_qos_profile_{name}": qos_object(QOS, qos) for name, qos in QOS_PROFILES.items()
}

_FIELD = "qos_overriding_options"
_ID_AT = 2
_NAMES = ("PublisherOptions", "SubscriptionOptions")


def overriding_options_argument(arguments: Arguments) -> av.Value | None:
    """Return the options of overriding among what an endpoint is made with."""
    for value in arguments.values[1:]:
        if isinstance(value, av.Instance) and _FIELD in value.fields:
            given = value.fields[_FIELD]
            return _overriding_options(given.items) if isinstance(given, av.ListValue) else given
    return None


def _make_endpoint_options(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`rclcpp::PublisherOptions()`, or a copy of others."""
    before = next((v.fields for v in arguments.values if isinstance(v, av.Instance)), {})
    return av.Instance(ENDPOINT_OPTIONS, {_FIELD: av.NONE, **before})


def _make_overriding_options(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`QosOverridingOptions({QosPolicyKind::Depth, …}, callback, id)`, or the policies alone."""
    return _overriding_options(arguments.values)


def _overriding_options(values: Sequence[av.Value]) -> av.Value:
    first = values[0] if values else av.list_of(())
    if isinstance(first, av.Instance) and POLICIES_FIELD in first.fields:
        return first
    if not isinstance(first, av.ListValue):
        return overriding_options(_OVERRIDING, av.list_of(tuple(values)), None)
    identity = values[_ID_AT] if len(values) > _ID_AT else None
    return overriding_options(_OVERRIDING, first, identity)


def _with_default_policies(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`QosOverridingOptions::with_default_policies(callback, id)`."""
    return with_default_policies(_OVERRIDING, arguments.get(1))


ENDPOINT_OPTIONS = av.LibraryClass("rclcpp::PublisherOptions", _make_endpoint_options)
_OVERRIDING = av.LibraryClass("rclcpp::QosOverridingOptions", _make_overriding_options)
OVERRIDING_CLASSES: Mapping[str, av.LibraryClass] = {
    **{
        f"rclcpp::{name}{more}": ENDPOINT_OPTIONS
        for name in _NAMES
        for more in ("", "WithAllocator")
    },
    "rclcpp::QosOverridingOptions": _OVERRIDING,
}
OVERRIDING_FUNCTIONS: Mapping[str, Callable[..., av.Value]] = {
    "rclcpp::QosOverridingOptions::with_default_policies": _with_default_policies
}
OVERRIDING_CONSTANTS: Mapping[str, av.Value] = {
    f"rclcpp::QosPolicyKind::{kind.title().replace('_', '')}": av.Scalar(kind)
    for kind in POLICY_KINDS
}
