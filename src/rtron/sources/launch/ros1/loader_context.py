"""What is in force at a place of a launch file: namespace, arguments, remaps and the like.

A scope is opened by `<launch>`, `<group>` and `<include>`; what happens in it stays in it, and it
begins as a copy of the one around it (ROS wiki: roslaunch/XML).
"""

import re
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, replace
from enum import IntEnum
from typing import NoReturn

from rtron.errors import InputError
from rtron.sources.launch.common.errors import MissingArgumentError, UnresolvableError
from rtron.sources.launch.common.xml_document import Element, line_of
from rtron.sources.launch.ros1.substitution_args import Argument, SubstitutionArgs
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
    `~name` parameters that each following node gets, `defaults` the arguments that nobody gives,
    nor what their defaults are made of.
    """

    namespace: str = "/"
    arguments: dict[str, Argument] = field(default_factory=dict)
    declared: set[str] = field(default_factory=set)
    remaps: dict[str, str] = field(default_factory=dict)
    environ: list[tuple[str, str]] = field(default_factory=list)
    private: dict[str, PrivateParameter] = field(default_factory=dict)
    defaults: set[str] = field(default_factory=set)
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
            defaults=set(self.defaults),
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

    def declare_default(self, name: str, value: Argument | None, used: set[str]) -> None:
        """Declare an argument, with its default if it has one, which uses other arguments."""
        self._declare_argument(name)
        if value is not None and name not in self.arguments:
            self.arguments[name] = value
            if used <= self.defaults:
                self.defaults.add(name)

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


_BOOLEANS = {"true": True, "1": True, "false": False, "0": False}


@dataclass(frozen=True, slots=True, kw_only=True)
class Tag:
    """One element of the file `path`; `substitution` knows the arguments in force there.

    Everything that evaluates raises InputError (the file is wrong), MissingArgumentError or
    UnresolvableError (the surroundings lack something).
    """

    element: Element
    path: str
    substitution: SubstitutionArgs

    @property
    def name(self) -> str:
        """The element's name."""
        return str(self.element.tag)

    @property
    def line(self) -> int:
        """The element's line, from 1."""
        return line_of(self.element)

    def children(self) -> Iterator["Tag"]:
        """Yield the elements within, comments left out."""
        for child in self.element.iterchildren("*"):
            yield Tag(element=child, path=self.path, substitution=self.substitution)

    def optional(self, attribute: str) -> str | None:
        """Return an attribute's value, or None where it is not written."""
        text = self.element.get(attribute)
        if not text:
            return text
        try:
            return self.substitution.replace(str(text))
        except ValueError as error:
            self.fail(f"{attribute}: {error}")

    def used_arguments(self, attribute: str) -> set[str]:
        """Return the names of the arguments that an attribute's value uses."""
        used: set[str] = set()
        with suppress(ValueError, MissingArgumentError, UnresolvableError):
            replace(self.substitution, used=used).replace(self.element.get(attribute) or "")
        return used

    def required(self, attribute: str) -> str:
        """Return an attribute's value; raise InputError where it is not written or empty."""
        value = self.optional(attribute)
        if not value:
            self.fail(f"has no '{attribute}'")
        return value

    def flag(self, attribute: str) -> bool | None:
        """Return an attribute that says true or false, None where it is not written."""
        value = self.optional(attribute)
        if value is None:
            return None
        if value.strip().lower() not in _BOOLEANS:
            self.fail(f"{attribute}: '{value}' is neither true nor false")
        return _BOOLEANS[value.strip().lower()]

    def boolean(self, attribute: str) -> bool:
        """Return an attribute that roslaunch takes only as `true` or `false`; false by default."""
        value = self.optional(attribute)
        if value is None:
            return False
        if value.lower() not in {"true", "false"}:
            self.fail(f"{attribute}: '{value}' is neither true nor false")
        return value.lower() == "true"

    def clears_parameters(self) -> bool:
        """Tell what `clear_params` says; empty counts as not written."""
        return bool(self.optional("clear_params")) and self.boolean("clear_params")

    def text(self) -> str:
        """Return the text between the element's start and end, other elements left out."""
        texts = [self.element.text, *(child.tail for child in self.element)]
        return "".join(str(piece) for piece in texts if piece)

    def applies(self) -> bool:
        """Tell what `if` and `unless` say."""
        if_value, unless_value = self.flag("if"), self.flag("unless")
        if if_value is not None and unless_value is not None:
            self.fail("has both 'if' and 'unless'")
        return not unless_value if if_value is None else if_value

    def fail(self, why: str) -> NoReturn:
        """Raise InputError at this element."""
        raise InputError(f"<{self.name}> {why}", path=self.path, line=self.line)
