"""Which parameters a node has: `list_parameters`, and those below a prefix."""

from collections.abc import Iterator

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.ros2_common.nodes import NAME_FIELD
from rtron.sources.code.library_models.ros2_common.parameters import (
    AUTOMATIC_FIELD,
    knows_all_overrides,
    override_value,
)

_ANY_DEPTH = 0
_RESULT = av.LibraryClass("rcl_interfaces/ListParametersResult")


def parameter_names(machine: AbstractMachine, node: av.Value) -> tuple[list[str], bool]:
    """Return the parameters that a node has declared, sorted, and whether these are all.

    A node that declares what a launch sets has all of that too.
    """
    names = set(_declared_names(machine, node))
    is_automatic = isinstance(node, av.Instance) and node.fields.get(AUTOMATIC_FIELD) == av.TRUE
    if is_automatic:
        given = {one.name for one in machine.recorder.site.settings}
        names |= {name for name in given if override_value(machine, node, av.Scalar(name))}
    return sorted(names), not is_automatic or knows_all_overrides(machine, node)


def _declared_names(machine: AbstractMachine, node: av.Value) -> Iterator[str]:
    full = node.fields.get(NAME_FIELD) if isinstance(node, av.Instance) else None
    start = f"{av.text_with_holes(full)} " if full is not None else " "
    for key in machine.parameters:
        if key.startswith(start):
            yield key.removeprefix(start)


def names_below(names: list[str], prefix: str) -> dict[str, str]:
    """Return those of some names that are below a prefix, with what stands behind it."""
    start = f"{prefix}." if prefix else ""
    return {name: name.removeprefix(start) for name in names if name.startswith(start)}


def list_parameters(machine: AbstractMachine, owner: av.Value, arguments: Arguments) -> av.Value:
    """`list_parameters(prefixes, depth)`: their names, and what stands before the last dots."""
    names, is_whole = parameter_names(machine, owner)
    prefixes, is_known = av.items_of(arguments.get(0, "prefixes") or av.NONE)
    depth = arguments.get(1, "depth")
    deepest = depth.value if isinstance(depth, av.Scalar) else _ANY_DEPTH
    texts = [str(one.value) for one in prefixes if isinstance(one, av.Scalar)]
    certain = is_whole and is_known and len(texts) == len(prefixes)
    listed = [name for name in names if _is_listed(name, texts, deepest)]
    before = dict.fromkeys(name.rpartition(".")[0] for name in listed if "." in name)
    fields = {"names": listed, "prefixes": before}
    return av.Instance(
        _RESULT,
        {key: av.list_of(map(av.Scalar, found), certain=certain) for key, found in fields.items()},
    )


def _is_listed(name: str, prefixes: list[str], depth: int) -> bool:
    """Tell whether a name is below a prefix, with fewer dots behind it than `depth`; 0 is any."""
    behind = [names_below([name], prefix).get(name) for prefix in prefixes or [""]]
    return name in prefixes or any(
        rest is not None and (depth == _ANY_DEPTH or rest.count(".") < depth) for rest in behind
    )
