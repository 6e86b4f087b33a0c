"""How names resolve in a node, and what the parameter server holds, for names known in part."""

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.vocabulary import ParameterValue, UnknownValue
from rtron.vocabulary.launch import canonical_name


def node_namespace(machine: AbstractMachine) -> str:
    """Return the namespace that the node of the process stands in."""
    return machine.recorder.site.process_name.rpartition("/")[0] or "/"


def resolve_name(
    machine: AbstractMachine, name: av.Value, namespace: av.Value | None = None
) -> av.Value:
    """Return a name as it resolves below a namespace, before remapping (ROS wiki: Names)."""
    below = namespace if namespace is not None else av.Scalar(node_namespace(machine))
    return av.join(
        [_resolve_one(machine, one, base) for one in av.options(name) for base in av.options(below)]
    )


def _resolve_one(machine: AbstractMachine, name: av.Value, namespace: av.Value) -> av.Value:
    parts = av.parts_of(name)
    first = parts[0] if parts else ""
    if isinstance(first, str) and first.startswith("/"):
        return _canonical(name)
    if isinstance(first, str) and first.startswith("~"):
        private = av.PartialText((first[1:], *parts[1:]), av.is_tainted(name))
        process = av.Scalar(machine.recorder.site.process_name + "/")
        return _canonical(av.concat((process, private)))
    return _canonical(av.concat((namespace, av.Scalar("/"), name)))


def _canonical(name: av.Value) -> av.Value:
    def cleaned(option: av.Value) -> av.Value:
        if isinstance(option, av.Scalar):
            return av.Scalar(canonical_name("/" + str(option.value)), option.tainted)
        return option

    return av.map_options(name, cleaned)


def remap_name(machine: AbstractMachine, name: av.Value) -> av.Value:
    """Return an absolute name as the node's remaps leave it."""
    remaps = dict(machine.recorder.site.remaps)

    def moved(option: av.Value) -> av.Value:
        if isinstance(option, av.Scalar):
            return av.Scalar(remaps.get(str(option.value), option.value), option.tainted)
        return option

    return av.map_options(name, moved)


def parameter_value(machine: AbstractMachine, name: av.Value) -> av.Value | None:
    """Return a parameter by its absolute name; None where it is certainly not set.

    What may or may not be set is an Unknown with the parameter's name.
    """
    found = [_one_parameter(machine, option) for option in av.options(name)]
    known = [value for value in found if value is not None]
    return av.join(known) if known else None


def _one_parameter(machine: AbstractMachine, name: av.Value) -> av.Value | None:
    machine.recorder.add_parameter(machine.recorder.site.name, av.text_with_holes(name), None)
    if not isinstance(name, av.Scalar):
        return av.Unknown(av.text_with_holes(name), tainted=True)
    site, full = machine.recorder.site, str(remap_name(machine, name).value)  # type: ignore[union-attr]
    if full in machine.parameters:
        return machine.parameters[full]
    found = site.parameters.get(full)
    if found is not None:
        return abstract_value(found.value, short_name(machine, full))
    return None if site.parameters_complete else av.Unknown(short_name(machine, full), tainted=True)


def is_set(found: av.Value | None) -> av.Value:
    """Return whether a parameter is set; an Unknown where it may be."""
    unknown = isinstance(found, av.Unknown)
    return av.FALSE if found is None else av.Unknown("is_set") if unknown else av.TRUE


def tainted_default(value: av.Value) -> av.Value:
    """Return a default marked as a parameter's, which the launch may change."""
    return av.Scalar(value.value, tainted=True) if isinstance(value, av.Scalar) else value


def short_name(machine: AbstractMachine, name: str) -> str:
    """Return an absolute name as a node's author would write it: `~topic` for a private one."""
    private = machine.recorder.site.name + "/"
    return "~" + name.removeprefix(private) if name.startswith(private) else name


def abstract_value(value: ParameterValue, name: str = "?") -> av.Value:
    """Return what a parameter holds as the interpreter's value, marked as a parameter's."""
    if isinstance(value, UnknownValue):
        return av.Unknown(name, tainted=True)
    if isinstance(value, dict):
        return av.MapValue(
            {key: abstract_value(inner, f"{name}/{key}") for key, inner in value.items()}
        )
    if isinstance(value, (list, tuple)):
        return av.list_of([abstract_value(inner, name) for inner in value])
    return av.Scalar(value, tainted=True)


def search_parameter(
    machine: AbstractMachine, name: av.Value, namespace: av.Value
) -> av.Value | None:
    """Return a parameter's full name, found upwards (ROS wiki: searchParam); None if nowhere."""
    if not (isinstance(name, av.Scalar) and isinstance(namespace, av.Scalar)):
        return av.Unknown(av.text_with_holes(name), tainted=True)
    site = machine.recorder.site
    found = site.parameters.search(str(name.value), str(namespace.value))
    if found is None:
        return None if site.parameters_complete else resolve_name(machine, name, namespace)
    return av.Scalar(found)
