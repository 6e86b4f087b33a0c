"""Python's `os.environ`: what the node's environment gives, and a note on what it does not."""

from dataclasses import dataclass

from rtron.sources.code.interpreter.abstract_values.value_types import (
    NONE,
    Hole,
    Known,
    MapValue,
    Value,
    spelled,
)
from rtron.sources.code.interpreter.execution.abstract_machine import Machine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.containers import PYTHON_MAP, Methods
from rtron.sources.declaration import NodeSite


@dataclass(eq=False, slots=True)
class Environment(MapValue):
    """The variables of a node's environment."""


def environment(site: NodeSite) -> Environment:
    """Return what a node sees as `os.environ`."""
    return Environment({name: Known(value) for name, value in site.environ})


def getenv(machine: Machine, owner: object, arguments: Arguments) -> Value:
    """`os.getenv(name, default)`, `os.environ.get(name, default)`; the default is noted."""
    name, default = arguments.get(0, "key"), arguments.get(1, "default") or NONE
    fields = (
        owner.fields
        if isinstance(owner, Environment)
        else environment(machine.recorder.site).fields
    )
    if not isinstance(name, Known):
        return Hole("environ")
    if name.value in fields:
        return fields[name.value]
    what = f"environment variable {name.value}"
    why = f"is not given; `{spelled(default)}` counts"
    machine.recorder.unresolved(what, why, arguments.evidence)
    return default


ENVIRONMENT: Methods = {**PYTHON_MAP, "get": getenv}
