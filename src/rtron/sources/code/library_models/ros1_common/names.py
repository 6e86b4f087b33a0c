"""How names resolve in a node, and what the parameter server says, for names known in part."""

from rtron.sources.code.interpreter.abstract_values.items import listed
from rtron.sources.code.interpreter.abstract_values.value_types import (
    Hole,
    Known,
    MapValue,
    Text,
    Value,
    concat,
    each,
    is_tainted,
    join,
    options,
    parts_of,
    spelled,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.vocabulary import ParameterValue, UnknownValue
from rtron.vocabulary.launch import canonical_name


def node_namespace(machine: Machine) -> str:
    """Return the namespace that the node stands in."""
    return machine.recorder.site.name.rpartition("/")[0] or "/"


def resolve(machine: Machine, name: Value, namespace: Value | None = None) -> Value:
    """Return a name as it resolves below a namespace, before remapping (ROS wiki: Names)."""
    below = namespace if namespace is not None else Known(node_namespace(machine))
    return join([_resolve(machine, one, base) for one in options(name) for base in options(below)])


def _resolve(machine: Machine, name: Value, namespace: Value) -> Value:
    parts = parts_of(name)
    first = parts[0] if parts else ""
    if isinstance(first, str) and first.startswith("/"):
        return _clean(name)
    if isinstance(first, str) and first.startswith("~"):
        private = Text((first[1:], *parts[1:]), is_tainted(name))
        return _clean(concat((Known(machine.recorder.site.name + "/"), private)))
    return _clean(concat((namespace, Known("/"), name)))


def _clean(name: Value) -> Value:
    def cleaned(option: Value) -> Value:
        if isinstance(option, Known):
            return Known(canonical_name("/" + str(option.value)), option.tainted)
        return option

    return each(name, cleaned)


def remapped(machine: Machine, name: Value) -> Value:
    """Return an absolute name as the node's remaps leave it."""
    remaps = dict(machine.recorder.site.remaps)

    def moved(option: Value) -> Value:
        if isinstance(option, Known):
            return Known(remaps.get(str(option.value), option.value), option.tainted)
        return option

    return each(name, moved)


def parameter(machine: Machine, name: Value) -> Value | None:
    """Return a parameter by its absolute name; None where it is certainly not set.

    What may or may not be set is a Hole that is called after the parameter.
    """
    found = [_parameter(machine, option) for option in options(name)]
    known = [value for value in found if value is not None]
    return join(known) if known else None


def _parameter(machine: Machine, name: Value) -> Value | None:
    if not isinstance(name, Known):
        return Hole(spelled(name), tainted=True)
    site, full = machine.recorder.site, str(remapped(machine, name).value)  # type: ignore[union-attr]
    if full in machine.parameters:
        return machine.parameters[full]
    found = site.parameters.get(full)
    if found is not None:
        return value_of(found.value, short(machine, full))
    return None if site.complete else Hole(short(machine, full), tainted=True)


def short(machine: Machine, name: str) -> str:
    """Return an absolute name as a node's author would write it: `~topic` for a private one."""
    private = machine.recorder.site.name + "/"
    return "~" + name.removeprefix(private) if name.startswith(private) else name


def value_of(value: ParameterValue, name: str = "?") -> Value:
    """Return what a parameter holds as the interpreter's value, marked as a parameter's."""
    if isinstance(value, UnknownValue):
        return Hole(name, tainted=True)
    if isinstance(value, dict):
        return MapValue({key: value_of(inner, f"{name}/{key}") for key, inner in value.items()})
    if isinstance(value, (list, tuple)):
        return listed([value_of(inner, name) for inner in value])
    return Known(value, tainted=True)


def search(machine: Machine, name: Value, namespace: Value) -> Value | None:
    """Return a parameter's full name, found upwards (ROS wiki: searchParam); None if nowhere."""
    if not (isinstance(name, Known) and isinstance(namespace, Known)):
        return Hole(spelled(name), tainted=True)
    site = machine.recorder.site
    found = site.parameters.search(str(name.value), str(namespace.value))
    if found is None:
        return None if site.complete else resolve(machine, name, namespace)
    return Known(found)
