"""rclcpp::QoS and its kin (rclcpp/qos.hpp)."""

from collections.abc import Callable, Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Hole,
    Instance,
    Known,
    NativeClass,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common.qos import (
    DEFAULT,
    DEPTH,
    DURABILITY,
    PROFILES,
    RELIABILITY,
    fields_of,
    is_qos,
    made,
    policy,
)
from rtron.vocabulary import Durability, Reliability

_UNKNOWN = Hole("?")


def _profile(name: str, machine: Machine, arguments: Arguments) -> Value:
    """Make a profile: `rclcpp::QoS(10)`, `QoS(KeepLast(10))`, `SensorDataQoS()`."""
    del machine
    new = made(QOS, PROFILES[name])
    for value in arguments.values:
        if isinstance(value, Instance) and is_qos(value):
            new.fields.update({key: value.fields[key] for key in fields_of(DEFAULT)})
        elif isinstance(value, Instance) and DEPTH in value.fields:
            new.fields[DEPTH] = value.fields[DEPTH]
        elif isinstance(value, Known) and isinstance(value.value, int):
            new.fields[DEPTH] = value
    return new


def _depth(_: Machine, arguments: Arguments) -> Value:
    """`rclcpp::KeepLast(n)`, `rclcpp::KeepAll()`."""
    return Instance(_INITIALISATION, {DEPTH: arguments.get(0) or Known(0)})


def _from_rmw(_: Machine, __: object, arguments: Arguments) -> Value:
    """`rclcpp::QoSInitialization::from_rmw(profile)`."""
    return arguments.get(0) or _UNKNOWN


def _set(field: str, value: Value, machine: Machine, owner: Instance, _: Arguments) -> Value:
    machine.trail.set(owner.fields, field, value)
    return owner


def _set_given(field: str, machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    given = arguments.get(0)
    value = given if field == DEPTH and given is not None else policy(given)
    machine.trail.set(owner.fields, field, value)
    return owner


def _itself(_: Machine, owner: Instance, __: Arguments) -> Value:
    return owner


def _get(field: str, _: Machine, owner: Instance, arguments: Arguments) -> Value:
    del arguments
    return owner.fields.get(field, _UNKNOWN)


_METHODS: Mapping[str, Callable[..., Value]] = {
    "reliable": partial(_set, RELIABILITY, Known(Reliability.RELIABLE.value)),
    "best_effort": partial(_set, RELIABILITY, Known(Reliability.BEST_EFFORT.value)),
    "reliability_best_available": partial(_set, RELIABILITY, Hole("best available")),
    "transient_local": partial(_set, DURABILITY, Known(Durability.TRANSIENT_LOCAL.value)),
    "durability_volatile": partial(_set, DURABILITY, Known(Durability.VOLATILE.value)),
    "durability_best_available": partial(_set, DURABILITY, Hole("best available")),
    "reliability": partial(_set_given, RELIABILITY),
    "durability": partial(_set_given, DURABILITY),
    "keep_last": partial(_set_given, DEPTH),
    "keep_all": partial(_set, DEPTH, Known(0)),
    "depth": partial(_get, DEPTH),
    **dict.fromkeys(
        (
            *("deadline", "lifespan", "liveliness", "liveliness_lease_duration", "history"),
            *("avoid_ros_namespace_conventions", "get_rmw_qos_profile"),
        ),
        _itself,
    ),
}
QOS = NativeClass("rclcpp::QoS", partial(_profile, "default"), dict(_METHODS))
_INITIALISATION = NativeClass("rclcpp::QoSInitialization", _depth)
_NAMED = {
    "SensorDataQoS": "sensor_data",
    "ServicesQoS": "services_default",
    "ParametersQoS": "parameters",
    "ParameterEventsQoS": "parameter_events",
    "ClockQoS": "clock",
    "RosoutQoS": "rosout",
    "SystemDefaultsQoS": "system_default",
}

QOS_CLASSES: Mapping[str, NativeClass] = {
    "rclcpp::QoS": QOS,
    **{
        f"rclcpp::{name}": NativeClass(f"rclcpp::{name}", partial(_profile, profile), QOS.methods)
        for name, profile in _NAMED.items()
    },
    **dict.fromkeys(
        ("rclcpp::KeepLast", "rclcpp::KeepAll", "rclcpp::QoSInitialization"), _INITIALISATION
    ),
}
QOS_FUNCTIONS: Mapping[str, Callable[..., Value]] = {
    "rclcpp::QoSInitialization::from_rmw": _from_rmw
}
QOS_CONSTANTS: Mapping[str, Value] = {
    f"rmw_qos_profile_{name}": made(QOS, qos) for name, qos in PROFILES.items()
}
