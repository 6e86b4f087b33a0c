"""roscpp's AdvertiseOptions and its kin: a name and a type for a later call."""

from rtron.sources.code.interpreter.abstract_values.value_types import (
    Instance,
    LibraryClass,
    Scalar,
    Unknown,
    Value,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.cpp_arguments import (
    escape_functions,
    template_message_type,
)

_UNKNOWN = Unknown("?")


def create_options(machine: AbstractMachine, _: object, arguments: Arguments) -> Value:
    """`AdvertiseOptions::create<T>(topic, …)`, `SubscribeOptions::create<T>(topic, …)`."""
    escape_functions(machine, arguments)
    type = Scalar(template_message_type(machine, arguments))
    return Instance(ADVERTISE_OPTIONS, {"options": arguments.get(0) or _UNKNOWN, "type": type})


def _make_options(_: AbstractMachine, arguments: Arguments) -> Value:
    return (
        Instance(ADVERTISE_OPTIONS, {"options": _UNKNOWN, "type": Scalar("")})
        if arguments
        else Unknown("options")
    )


def _init_options(machine: AbstractMachine, owner: Instance, arguments: Arguments) -> Value:
    """`SubscribeOptions::init<T>(topic, queue, callback)`."""
    escape_functions(machine, arguments)
    machine.undo_log.set(owner.fields, "options", arguments.get(0) or _UNKNOWN)
    machine.undo_log.set(owner.fields, "type", Scalar(template_message_type(machine, arguments)))
    return owner


ADVERTISE_OPTIONS = LibraryClass(
    "ros::AdvertiseOptions",
    methods=dict.fromkeys(("init", "initByFullCallbackType"), _init_options),
)

OPTIONS_CLASSES = {
    name: LibraryClass(name, _make_options)
    for name in (
        "ros::AdvertiseOptions",
        "ros::SubscribeOptions",
        "ros::AdvertiseServiceOptions",
        "ros::ServiceClientOptions",
    )
}
