"""How names resolve in a node, and what the parameter server holds, for names known in part."""

from rtron.sources.code.interpreter.abstract_values.items import list_of
from rtron.sources.code.interpreter.abstract_values.value_types import (
    MapValue,
    PartialText,
    Scalar,
    Unknown,
    Value,
    concat,
    is_tainted,
    join,
    map_options,
    options,
    parts_of,
    text_with_holes,
)
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.vocabulary import ParameterValue, UnknownValue
from rtron.vocabulary.launch import canonical_name


def node_namespace(machine: AbstractMachine) -> str:
    """Return the namespace that the node of the process stands in."""
    return machine.recorder.site.process_name.rpartition("/")[0] or "/"


def resolve_name(machine: AbstractMachine, name: Value, namespace: Value | None = None) -> Value:
    """Return a name as it resolves below a namespace, before remapping (ROS wiki: Names)."""
    below = namespace if namespace is not None else Scalar(node_namespace(machine))
    return join(
        [_resolve_one(machine, one, base) for one in options(name) for base in options(below)]
    )


def _resolve_one(machine: AbstractMachine, name: Value, namespace: Value) -> Value:
    parts = parts_of(name)
    first = parts[0] if parts else ""
    if isinstance(first, str) and first.startswith("/"):
        return _canonical(name)
    if isinstance(first, str) and first.startswith("~"):
        private = PartialText((first[1:], *parts[1:]), is_tainted(name))
        process = Scalar(machine.recorder.site.process_name + "/")
        return _canonical(concat((process, private)))
    return _canonical(concat((namespace, Scalar("/"), name)))


def _canonical(name: Value) -> Value:
    def cleaned(option: Value) -> Value:
        if isinstance(option, Scalar):
            return Scalar(canonical_name("/" + str(option.value)), option.tainted)
        return option

    return map_options(name, cleaned)


def remap_name(machine: AbstractMachine, name: Value) -> Value:
    """Return an absolute name as the node's remaps leave it."""
    remaps = dict(machine.recorder.site.remaps)

    def moved(option: Value) -> Value:
        if isinstance(option, Scalar):
            return Scalar(remaps.get(str(option.value), option.value), option.tainted)
        return option

    return map_options(name, moved)


def parameter_value(machine: AbstractMachine, name: Value) -> Value | None:
    """Return a parameter by its absolute name; None where it is certainly not set.

    What may or may not be set is an Unknown with the parameter's name.
    """
    found = [_one_parameter(machine, option) for option in options(name)]
    known = [value for value in found if value is not None]
    return join(known) if known else None


def _one_parameter(machine: AbstractMachine, name: Value) -> Value | None:
    machine.recorder.add_parameter(machine.recorder.site.name, text_with_holes(name), None)
    if not isinstance(name, Scalar):
        return Unknown(text_with_holes(name), tainted=True)
    site, full = machine.recorder.site, str(remap_name(machine, name).value)  # type: ignore[union-attr]
    if full in machine.parameters:
        return machine.parameters[full]
    found = site.parameters.get(full)
    if found is not None:
        return abstract_value(found.value, short_name(machine, full))
    return None if site.parameters_complete else Unknown(short_name(machine, full), tainted=True)


def short_name(machine: AbstractMachine, name: str) -> str:
    """Return an absolute name as a node's author would write it: `~topic` for a private one."""
    private = machine.recorder.site.name + "/"
    return "~" + name.removeprefix(private) if name.startswith(private) else name


def abstract_value(value: ParameterValue, name: str = "?") -> Value:
    """Return what a parameter holds as the interpreter's value, marked as a parameter's."""
    if isinstance(value, UnknownValue):
        return Unknown(name, tainted=True)
    if isinstance(value, dict):
        return MapValue(
            {key: abstract_value(inner, f"{name}/{key}") for key, inner in value.items()}
        )
    if isinstance(value, (list, tuple)):
        return list_of([abstract_value(inner, name) for inner in value])
    return Scalar(value, tainted=True)


def search_parameter(machine: AbstractMachine, name: Value, namespace: Value) -> Value | None:
    """Return a parameter's full name, found upwards (ROS wiki: searchParam); None if nowhere."""
    if not (isinstance(name, Scalar) and isinstance(namespace, Scalar)):
        return Unknown(text_with_holes(name), tainted=True)
    site = machine.recorder.site
    found = site.parameters.search(str(name.value), str(namespace.value))
    if found is None:
        return None if site.parameters_complete else resolve_name(machine, name, namespace)
    return Scalar(found)
