"""rclpy.qos: profiles, and the policies in them (docs.ros.org: rclpy.qos)."""

from collections.abc import Mapping
from functools import partial

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Foreign,
    Hole,
    Instance,
    Known,
    Native,
    NativeClass,
    Value,
    each,
    spelled,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common.qos import (
    DEFAULT,
    DEPTH,
    DURABILITY,
    PROFILES,
    RELIABILITY,
    policy,
    qos_of,
)
from rtron.sources.declaration import DeclarationKind
from rtron.vocabulary import QoS

_FIELDS = {"depth": DEPTH, "reliability": RELIABILITY, "durability": DURABILITY}
_PLACES = {DeclarationKind.PUBLISH: 2, DeclarationKind.SUBSCRIBE: 3}
_PRESETS = {
    "SENSOR_DATA": "sensor_data",
    "SYSTEM_DEFAULT": "system_default",
    "SERVICES_DEFAULT": "services_default",
    "PARAMETERS": "parameters",
    "PARAMETER_EVENTS": "parameter_events",
    "ACTION_STATUS_DEFAULT": "action_status_default",
}


def quality(kind: DeclarationKind, arguments: Arguments, at: int) -> QoS | None:
    """Return the quality of service that an endpoint is made with, where it is literal."""
    if kind not in _PLACES:
        return None
    return read(arguments.get(at + _PLACES[kind], "qos_profile"))


def read(value: Value | None) -> QoS | None:
    """Return what a profile, or a depth alone, says."""
    if not isinstance(value, Instance) or value.type is not _PROFILE:
        return qos_of(value)
    found = {key: value.fields[name] for name, key in _FIELDS.items()}
    plain = {key: one if key == DEPTH else policy(one) for key, one in found.items()}
    return qos_of(Instance(_PROFILE, plain))


def _make(_: Machine, arguments: Arguments) -> Value:
    """`QoSProfile(depth=…, reliability=…, durability=…)`."""
    made = _profile(DEFAULT)
    made.fields.update({n: v for n, v in arguments.keywords.items() if n in _FIELDS})
    return made


def _profile(qos: QoS) -> Instance:
    fields: dict[object, Value] = {
        "depth": Known(qos.depth),
        "reliability": Known(qos.reliability.value),
        "durability": Known(qos.durability.value),
    }
    return Instance(_PROFILE, fields)


def profiles() -> Mapping[str, Value]:
    """Return the profiles of rclpy.qos, new ones for each program."""
    presets: dict[str, Value] = {
        name: Instance(_PRESET, {"value": _profile(PROFILES[profile])})
        for name, profile in _PRESETS.items()
    }
    named = {f"rclpy.qos.qos_profile_{name}": _profile(qos) for name, qos in PROFILES.items()}
    return {
        **{f"{_PRESET.name}.{name}": preset for name, preset in presets.items()},
        f"{_PRESET.name}.get_from_short_key": Native("key", partial(_of_short_key, presets)),
        _PRESET.name: Foreign(_PRESET.name),
        **named,
        _PROFILE.name: _PROFILE,
    }


def _of_short_key(
    presets: Mapping[str, Value], _: Machine, __: object, arguments: Arguments
) -> Value:
    """`QoSPresetProfiles.get_from_short_key("sensor_data")`."""

    def named(key: Value) -> Value:
        found = presets.get(spelled(key).upper())
        return found.fields["value"] if isinstance(found, Instance) else Hole("profile")

    return each(arguments.get(0, "name") or Hole("?"), named)


_PROFILE = NativeClass("rclpy.qos.QoSProfile", _make)
_PRESET = NativeClass("rclpy.qos.QoSPresetProfiles")
