"""Python's `os.environ`: what the node's environment gives, and a note on what it does not."""

from dataclasses import dataclass

from rtron.sources.code.interpreter import abstract_values as av
from rtron.sources.code.interpreter.execution.abstract_machine import AbstractMachine
from rtron.sources.code.interpreter.execution.arguments import Arguments
from rtron.sources.code.library_models.common.containers import LibraryMethods
from rtron.sources.code.library_models.common.maps import DICT_METHODS
from rtron.sources.declaration import NodeSite
from rtron.sources.launch.common.environment import unset_reason
from rtron.vocabulary import UnresolvedCause


@dataclass(eq=False, slots=True)
class EnvironmentValue(av.MapValue):
    """The variables of a node's environment."""

    def missing_note(self, key: object) -> tuple[str, str] | None:
        """Return that a variable is not given."""
        return f"environment variable {key}", unset_reason(None)


def environment_value(site: NodeSite) -> EnvironmentValue:
    """Return what a node sees as `os.environ`: what is given, and the ROS that is sourced."""
    environ = {"ROS_VERSION": str(site.ros), **dict(site.environ)}
    return EnvironmentValue({name: av.Scalar(value) for name, value in environ.items()})


def getenv(machine: AbstractMachine, owner: object, arguments: Arguments) -> av.Value:
    """`os.getenv(name, default)`, `os.environ.get(name, default)`; the default is noted."""
    name, default = arguments.get(0, "key"), arguments.get(1, "default") or av.NONE
    if not isinstance(owner, EnvironmentValue):
        owner = environment_value(machine.recorder.site)
    fields = owner.fields
    if not isinstance(name, av.Scalar):
        return av.Unknown("environ")
    if name.value in fields:
        return fields[name.value]
    shown = None if default is av.NONE else av.text_with_holes(default)
    what, why = f"environment variable {name.value}", unset_reason(shown)
    cause = UnresolvedCause.UNSET_VARIABLE
    machine.recorder.add_unresolved(what, why, arguments.evidence, cause=cause)
    return default


ENVIRONMENT_METHODS: LibraryMethods = {**DICT_METHODS, "get": getenv}
