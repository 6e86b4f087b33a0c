"""What an evaluation knows and keeps: packages, arguments, open files, bounds, what failed."""

import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial

from rtron.errors import InputError
from rtron.sources.launch.common.errors import MissingArgumentError, UnresolvableError
from rtron.sources.launch.common.expression import evaluate_with
from rtron.sources.launch.common.expression_library import Value
from rtron.sources.launch.common.packages import PackageIndex
from rtron.sources.launch.ros1.substitution_args import Substitution
from rtron.sources.xacro.budget import Budget
from rtron.sources.xacro.expression import XacroWalk
from rtron.sources.xacro.files import local_path
from rtron.sources.xacro.scopes import Namespace, Scope
from rtron.sources.xacro.text import Text
from rtron.sources.xacro.xml_element import XMLNS, XmlElement
from rtron.sources.xacro.yaml_file import load_yaml
from rtron.vocabulary import Evidence, Unresolved

MAX_NOTES = 1000

_UNRESOLVED = (UnresolvableError, MissingArgumentError, ValueError)


@dataclass(slots=True, kw_only=True)
class Surroundings:
    """The state of one evaluation; `files` are those being read, the innermost last."""

    packages: PackageIndex
    environ: Mapping[str, str]
    arguments: dict[str, str]
    files: list[str]
    budget: Budget = field(default_factory=Budget)
    namespaces: dict[str, str] = field(default_factory=dict)
    read: set[str] = field(default_factory=set)
    notes: dict[Unresolved, None] = field(default_factory=dict)

    def value(self, text: str, symbols: Scope) -> Value:
        """Return a text's value in a scope.

        Raise ValueError, UnresolvableError or MissingArgumentError where it has none.
        """
        expression = partial(self._expression, symbols)
        return Text(expression, self._command, self.budget).value(text)

    def declare(self, root: XmlElement) -> None:
        """Keep the namespaces that a file declares: its elements are going to need them."""
        declared = {k: v for k, v in root.attributes.items() if k.startswith(XMLNS)}
        self.namespaces = {**declared, **self.namespaces}

    def note(self, element: XmlElement, what: str, why: str, *more: Evidence) -> None:
        """Keep that something at an element is not resolved, and why; the same counts once."""
        if len(self.notes) < MAX_NOTES:
            evidence = (element.evidence, *more)
            self.notes[Unresolved(what=what, why=why, evidence=evidence)] = None

    @contextmanager
    def noting(self, element: XmlElement, what: str = "") -> Iterator[None]:
        """Note what turns out to be unresolvable at an element, and leave it at that."""
        what = what or f"<{element.tag}>"
        try:
            yield
        except InputError as error:
            place = [Evidence(file=error.path, line=error.line)] if error.path else []
            self.note(element, what, str(error), *place)
        except RecursionError:
            self.note(element, what, "is nested too deep")
        except _UNRESOLVED as error:
            self.note(element, what, str(error))

    @contextmanager
    def reading(self, path: str) -> Iterator[None]:
        """Make `path` the file that relative names are relative to."""
        self.read.add(path)
        self.files.append(path)
        try:
            yield
        finally:
            self.files.pop()

    def _expression(self, symbols: Scope, text: str) -> Value:
        functions = {
            "abs_filename": lambda name: local_path(name, self.files[-1]),
            "arg": self._argument,
            "load_yaml": self._load_yaml,
        }
        return evaluate_with(XacroWalk(functions, partial(self._name, symbols), self.budget), text)

    def _name(self, symbols: Scope, name: str) -> Value:
        value = symbols.get(name, self.value)
        return Namespace(value, self.value) if isinstance(value, Scope) else value

    def _argument(self, name: str) -> str:
        if name not in self.arguments:
            raise MissingArgumentError(name)
        return self.arguments[name]

    def _command(self, text: str) -> str:
        if text == "$(cwd)":
            return os.getcwd()  # noqa: PTH109 - a name, as xacro gives it
        substitution = Substitution(
            packages=self.packages,
            environ=self.environ,
            folder=os.path.dirname(self.files[-1]),  # noqa: PTH120 - no links followed
            arguments=self.arguments,
        )
        return substitution.replace(text)

    def _load_yaml(self, name: str) -> Value:
        path = local_path(name, self.files[-1])
        self.budget.file()
        try:
            with self.reading(str(path)):
                return load_yaml(path, lambda text: self._expression(Scope(), text))
        except InputError as error:
            raise UnresolvableError(str(error)) from None
