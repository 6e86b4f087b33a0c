"""rclpy.qos: profiles, and the policies in them (docs.ros.org: rclpy.qos)."""

from collections.abc import Mapping

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common.qos import (
    DEFAULT_QOS,
    DEPTH_FIELD,
    DURABILITY_FIELD,
    POLICY_KINDS,
    QOS_PROFILES,
    RELIABILITY_FIELD,
    overriding_options,
    policy_value,
    read_qos,
    with_default_policies,
)
from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import QoS

_FIELDS = {"depth": DEPTH_FIELD, "reliability": RELIABILITY_FIELD, "durability": DURABILITY_FIELD}
_QOS_POSITIONS = {DeclarationKind.PUBLISH: 2, DeclarationKind.SUBSCRIBE: 3}
_PRESETS = {
    "SENSOR_DATA": "sensor_data",
    "SYSTEM_DEFAULT": "system_default",
    "SERVICES_DEFAULT": "services_default",
    "PARAMETERS": "parameters",
    "PARAMETER_EVENTS": "parameter_events",
    "ACTION_STATUS_DEFAULT": "action_status_default",
}


def endpoint_qos(kind: DeclarationKind, arguments: Arguments, at: int) -> QoS | None:
    """Return the quality of service that an endpoint is made with, where it is literal."""
    if kind not in _QOS_POSITIONS:
        return None
    return read_profile(arguments.get(at + _QOS_POSITIONS[kind], "qos_profile"))


def read_profile(value: av.Value | None) -> QoS | None:
    """Return what a profile, or a depth alone, says."""
    if not isinstance(value, av.Instance) or value.type is not _PROFILE:
        return read_qos(value)
    found = {key: value.fields[name] for name, key in _FIELDS.items()}
    plain = {key: one if key == DEPTH_FIELD else policy_value(one) for key, one in found.items()}
    return read_qos(av.Instance(_PROFILE, plain))


def _make_profile(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`QoSProfile(depth=…, reliability=…, durability=…)`."""
    made = _profile_object(DEFAULT_QOS)
    made.fields.update({n: v for n, v in arguments.keywords.items() if n in _FIELDS})
    return made


def _profile_object(qos: QoS) -> av.Instance:
    fields: dict[object, av.Value] = {
        "depth": av.Scalar(qos.depth),
        "reliability": av.Scalar(qos.reliability.value),
        "durability": av.Scalar(qos.durability.value),
    }
    return av.Instance(_PROFILE, fields)


def library_profiles() -> Mapping[str, av.Value]:
    """Return the profiles of rclpy.qos, new ones for each program."""
    presets: dict[str, av.Value] = {
        name: av.Instance(_PRESET_PROFILES, {"value": _profile_object(QOS_PROFILES[profile])})
        for name, profile in _PRESETS.items()
    }
    named = {
        f"rclpy.qos.qos_profile_{name}": _profile_object(qos) for name, qos in QOS_PROFILES.items()
    }
    return {
        **{f"{_PRESET_PROFILES.name}.{name}": preset for name, preset in presets.items()},
        _PRESET_PROFILES.name: av.ExternalSymbol(_PRESET_PROFILES.name),
        **named,
        _PROFILE.name: _PROFILE,
    }


_PROFILE = av.LibraryClass("rclpy.qos.QoSProfile", _make_profile)
_PRESET_PROFILES = av.LibraryClass("rclpy.qos.QoSPresetProfiles")


def _make_overriding_options(_: AbstractMachine, arguments: Arguments) -> av.Value:
    """`QoSOverridingOptions(policy_kinds, callback=…, entity_id=…)`."""
    policies = arguments.get(0, "policy_kinds") or av.Unknown("policy_kinds")
    return overriding_options(_OVERRIDING_OPTIONS, policies, _entity_id(arguments))


def _with_default_policies(_: AbstractMachine, __: object, arguments: Arguments) -> av.Value:
    """`QoSOverridingOptions.with_default_policies(callback=…, entity_id=…)`."""
    return with_default_policies(_OVERRIDING_OPTIONS, _entity_id(arguments))


def _entity_id(arguments: Arguments) -> av.Value | None:
    found = arguments.keywords.get("entity_id")
    return None if found == av.Scalar(None) else found


_OVERRIDING_OPTIONS = av.LibraryClass(
    "rclpy.qos_overriding_options.QoSOverridingOptions",
    _make_overriding_options,
    {"with_default_policies": _with_default_policies},
)
OVERRIDING_CLASSES: Mapping[str, av.Value] = {
    _OVERRIDING_OPTIONS.name: _OVERRIDING_OPTIONS,
    **{f"rclpy.qos.QoSPolicyKind.{kind.upper()}": av.Scalar(kind) for kind in POLICY_KINDS},
}
