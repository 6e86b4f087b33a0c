"""roscpp's AdvertiseOptions and its kin: a name and a type for a later call."""

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Hole,
    Instance,
    Known,
    NativeClass,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import escape_all, typed

_UNKNOWN = Hole("?")


def options_of(machine: Machine, _: object, arguments: Arguments) -> Value:
    """`AdvertiseOptions::create<T>(topic, …)`, `SubscribeOptions::create<T>(topic, …)`."""
    escape_all(machine, arguments)
    type = Known(typed(machine, arguments))
    return Instance(OPTIONS, {"options": arguments.get(0) or _UNKNOWN, "type": type})


def _no_options(_: Machine, arguments: Arguments) -> Value:
    return (
        Instance(OPTIONS, {"options": _UNKNOWN, "type": Known("")})
        if arguments
        else Hole("options")
    )


def _init_options(machine: Machine, owner: Instance, arguments: Arguments) -> Value:
    """`SubscribeOptions::init<T>(topic, queue, callback)`."""
    escape_all(machine, arguments)
    machine.trail.set(owner.fields, "options", arguments.get(0) or _UNKNOWN)
    machine.trail.set(owner.fields, "type", Known(typed(machine, arguments)))
    return owner


OPTIONS = NativeClass(
    "ros::AdvertiseOptions",
    methods=dict.fromkeys(("init", "initByFullCallbackType"), _init_options),
)

OPTIONS_CLASSES = {
    name: NativeClass(name, _no_options)
    for name in (
        "ros::AdvertiseOptions",
        "ros::SubscribeOptions",
        "ros::AdvertiseServiceOptions",
        "ros::ServiceClientOptions",
    )
}
