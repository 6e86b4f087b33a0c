"""What is in force at a place of a launch file: namespace, arguments, remaps and the like.

A scope is opened by `<launch>`, `<group>` and `<include>`; what happens in it stays in it, and it
begins as a copy of the one around it (ROS wiki: roslaunch/XML).
"""

import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from enum import IntEnum

from rtron.sources.launch.common.errors import UnresolvableError
from rtron.sources.launch.ros1.substitution_args import Argument
from rtron.vocabulary import Evidence, ParameterValue
from rtron.vocabulary.launch import canonical_name

_LEGAL_NAME = re.compile(r"[~/A-Za-z][\w/]*")


class Uncertainty(IntEnum):
    """Whether a place counts hangs on a condition that is not known: its own, or one around it."""

    NONE = 0
    INHERITED = 1
    OWN = 2


@dataclass(frozen=True, slots=True, kw_only=True)
class PrivateParameter:
    """A `<param>` with its name as it is written, before it stands below a node."""

    name: str
    value: ParameterValue
    evidence: Evidence
    uncertainty: Uncertainty = Uncertainty.NONE


@dataclass(slots=True, kw_only=True)
class LoaderContext:
    """What holds at one element of a launch file.

    `passes_all_arguments` marks a file that got all arguments of its includer. `private` holds the
    `~name` parameters that each following node gets.
    """

    namespace: str = "/"
    arguments: dict[str, Argument] = field(default_factory=dict)
    declared: set[str] = field(default_factory=set)
    remaps: dict[str, str] = field(default_factory=dict)
    environ: list[tuple[str, str]] = field(default_factory=list)
    private: dict[str, PrivateParameter] = field(default_factory=dict)
    passes_all_arguments: bool = False
    uncertainty: Uncertainty = Uncertainty.NONE

    def child(self, namespace: str | None) -> "LoaderContext":
        """Return the scope of a group or node in `namespace`; raise ValueError if that is none."""
        return LoaderContext(
            namespace=self._child_namespace(namespace),
            arguments=dict(self.arguments),
            declared=set(self.declared),
            remaps=dict(self.remaps),
            environ=list(self.environ),
            private=dict(self.private),
            uncertainty=min(self.uncertainty, Uncertainty.INHERITED),
        )

    def for_included_file(self, namespace: str | None, *, pass_all: bool) -> "LoaderContext":
        """Return the scope of an included file: our namespace and remaps, its own arguments.

        As in roslaunch, private parameters of the file count after it too, if there were any
        before it.
        """
        return LoaderContext(
            namespace=self._child_namespace(namespace),
            arguments=dict(self.arguments) if pass_all else {},
            remaps=dict(self.remaps),
            environ=list(self.environ),
            private=self.private or {},
            passes_all_arguments=pass_all,
            uncertainty=min(self.uncertainty, Uncertainty.INHERITED),
        )

    def uncertain(self) -> "LoaderContext":
        """Return this very scope for an element of which it is not known whether it counts."""
        return replace(self, uncertainty=Uncertainty.OWN)

    def set_argument(self, name: str, value: Argument) -> None:
        """Give an argument its value; raise ValueError if it has one or is declared twice."""
        self._declare_argument(name)
        if name in self.arguments and not self.passes_all_arguments:
            raise ValueError(f"argument '{name}' is already set and cannot be set again")
        self.arguments[name] = value

    def declare_default(self, name: str, value: Argument | None) -> None:
        """Declare an argument, with its default if it has one."""
        self._declare_argument(name)
        if value is not None:
            self.arguments.setdefault(name, value)

    def declare_unknown(self, name: str, why: str) -> None:
        """Declare an argument of which no value can be known."""
        self.declared.add(name)
        self.arguments[name] = UnresolvableError(why)

    def private_parameter(self, parameter: PrivateParameter) -> None:
        """Put a `~name` parameter in force; it replaces an earlier one of the same spelling."""
        name = canonical_name(parameter.name)
        self.private.pop(name, None)
        self.private[name] = parameter

    def remap(self, name_text: str, target: str) -> None:
        """Put a remap in force; it replaces an earlier one of the same spelling."""
        source, target = canonical_name(name_text), canonical_name(target)
        for name in (source, target):
            if not _LEGAL_NAME.fullmatch(name):
                raise ValueError(f"remap: '{name}' is no legal name")
        self.remaps.pop(source, None)
        self.remaps[source] = target

    def _declare_argument(self, name: str) -> None:
        if name in self.declared and not self.passes_all_arguments:
            raise ValueError(f"argument '{name}' is declared twice")
        self.declared.add(name)

    def _child_namespace(self, namespace: str | None) -> str:
        if namespace is None:
            return self.namespace
        if not namespace or namespace.startswith("~"):
            raise ValueError(f"'{namespace}' is no namespace")
        return canonical_name(
            f"/{self.namespace}/{namespace}" if namespace[0] != "/" else namespace
        )


def root_context(arguments: Mapping[str, str], namespace: str) -> LoaderContext:
    """Return the scope of the launch file itself.

    An empty argument counts as not given, as on roslaunch's command line.
    """
    passed: dict[str, Argument] = {name: value for name, value in arguments.items() if value}
    return LoaderContext(namespace=canonical_name(f"/{namespace}"), arguments=passed)
