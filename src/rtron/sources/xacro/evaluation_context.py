"""What an evaluation knows and keeps: packages, arguments, open files, bounds, what failed."""

import os
import os.path
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import partial
from itertools import islice
from pathlib import Path
from typing import TypeAlias

from rtron.errors import InputError
from rtron.sources.launch.common.errors import MissingArgumentError, UnresolvableError
from rtron.sources.launch.common.expression import evaluate_with
from rtron.sources.launch.common.expression_library import Value
from rtron.sources.launch.common.packages import PackageIndex
from rtron.sources.launch.ros1.substitution_args import SubstitutionArgs
from rtron.sources.xacro.budget import EvaluationBudget
from rtron.sources.xacro.expression import XacroExpressionEvaluator
from rtron.sources.xacro.scopes import NamespaceView, PropertyScope
from rtron.sources.xacro.xml_element import XMLNS, XmlElement, statement_name
from rtron.sources.xacro.yaml_file import load_yaml
from rtron.vocabulary import Evidence, UnresolvedCause, UnresolvedItem
from rtron.vocabulary.enums import HiddenPart

MAX_MATCHES = 200

_WILDCARD = re.compile(r"[*\[?]")


def local_path(name: str, file: str) -> Path:
    """Return the path that `name` means in `file`, `..` taken out without a look at it."""
    return Path(os.path.normpath(os.path.join(os.path.dirname(file), name)))  # noqa: PTH118, PTH120


def included_files(name: str, file: str) -> list[Path]:
    """Return the files that an include names, in order; wildcards stand in the last part only."""
    if not name.strip() or "\0" in name:
        raise ValueError(f"{name!r} is no file name")
    path = local_path(name, file)
    if not _WILDCARD.search(name):
        return [path]
    if _WILDCARD.search(str(path.parent)):
        raise UnresolvableError(f"{name}: wildcards in a folder's name are not followed")
    return sorted(islice(path.parent.glob(path.name), MAX_MATCHES))


Part: TypeAlias = tuple[str, str]

_TOKEN = re.compile(
    r"\$(?P<escaped>\$+[{(])|\$\{(?P<expression>[^}]*)\}|\$\((?P<command>[^)]*)\)"
    r"|(?P<text>[^$]+|\$[^{($]+|\$$)"
)


@dataclass(frozen=True, slots=True)
class TextEvaluator:
    """Evaluates texts: `expression` and `command` say what stands in `${…}` and in `$(…)`.

    Both raise ValueError, UnresolvableError or MissingArgumentError; so does `evaluate`.
    """

    expression: Callable[[str], Value]
    command: Callable[[str], str]
    budget: EvaluationBudget

    def evaluate(self, text: str) -> Value:
        """Return a text's value: a single expression keeps its type, everything else is joined."""
        if "$" not in text:
            return text
        values = [self._evaluate_part(kind, part) for kind, part in _split_parts(text)]
        self.budget.count_steps(len(values))
        if len(values) == 1:
            return values[0]
        pieces = [str(value) for value in values]
        self.budget.count_text(sum(map(len, pieces)))
        return "".join(pieces)

    def _evaluate_part(self, kind: str, part: str) -> Value:
        if kind == "expression":
            return self.expression(str(self.evaluate(part)))
        if kind == "command":
            return self.command(f"$({self.evaluate(part)})")
        return part


def _split_parts(text: str) -> Iterator[Part]:
    position = 0
    while position < len(text):
        match = _TOKEN.match(text, position)
        if match is None:
            raise ValueError(f"`{text[position : position + 40]}` is no expression")
        yield str(match.lastgroup), str(match[str(match.lastgroup)])
        position = match.end()


MAX_NOTES = 1000


@dataclass(slots=True, kw_only=True)
class EvaluationContext:
    """The state of one evaluation; `open_files` are those being read, the innermost last."""

    packages: PackageIndex
    environ: Mapping[str, str]
    arguments: dict[str, str]
    open_files: list[str]
    budget: EvaluationBudget = field(default_factory=EvaluationBudget)
    namespaces: dict[str, str] = field(default_factory=dict)
    files_read: set[str] = field(default_factory=set)
    notes: dict[UnresolvedItem, None] = field(default_factory=dict)

    def evaluate_text(self, text: str, symbols: PropertyScope) -> Value:
        """Return a text's value in a scope.

        Raise ValueError, UnresolvableError or MissingArgumentError where it has none.
        """
        expression = partial(self._expression, symbols)
        return TextEvaluator(expression, self._command, self.budget).evaluate(text)

    def add_namespaces(self, root: XmlElement) -> None:
        """Keep the namespaces that a file declares: its elements are going to need them."""
        declared = {k: v for k, v in root.attributes.items() if k.startswith(XMLNS)}
        self.namespaces = {**declared, **self.namespaces}

    def add_unresolved(
        self,
        element: XmlElement,
        what: str,
        why: str,
        *more: Evidence,
        cause: UnresolvedCause | None = None,
    ) -> None:
        """Keep that something at an element is not resolved, and why; the same counts once."""
        if len(self.notes) < MAX_NOTES:
            evidence = (element.evidence, *more)
            hides = HiddenPart.NODES if statement_name(element) == "include" else None
            note = UnresolvedItem(what=what, why=why, hides=hides, cause=cause, evidence=evidence)
            self.notes[note] = None

    @contextmanager
    def noting_errors(self, element: XmlElement, what: str = "") -> Iterator[None]:
        """Note what turns out to be unresolvable at an element, and leave it at that."""
        what = what or f"<{element.tag}>"
        try:
            yield
        except InputError as error:
            location = [Evidence(file=error.path, line=error.line)] if error.path else []
            self.add_unresolved(element, what, str(error), *location)
        except RecursionError:
            self.add_unresolved(element, what, "is nested too deep")
        except UnresolvableError as error:
            cause = UnresolvedCause.MISSING_SOURCE if error.package else None
            self.add_unresolved(element, what, str(error), cause=cause)
        except (MissingArgumentError, ValueError) as error:
            follows = any(note.hides for note in self.notes)
            cause = UnresolvedCause.INCOMPLETE_DESCRIPTION if follows else None
            self.add_unresolved(element, what, str(error), cause=cause)

    @contextmanager
    def reading_file(self, path: str) -> Iterator[None]:
        """Make `path` the file that relative names are relative to."""
        self.files_read.add(path)
        self.open_files.append(path)
        try:
            yield
        finally:
            self.open_files.pop()

    def _expression(self, symbols: PropertyScope, text: str) -> Value:
        functions = {
            "abs_filename": lambda name: local_path(name, self.open_files[-1]),
            "arg": self._argument,
            "load_yaml": self._load_yaml,
        }
        return evaluate_with(
            XacroExpressionEvaluator(functions, partial(self._name, symbols), self.budget), text
        )

    def _name(self, symbols: PropertyScope, name: str) -> Value:
        value = symbols.get(name, self.evaluate_text)
        return (
            NamespaceView(value, self.evaluate_text) if isinstance(value, PropertyScope) else value
        )

    def _argument(self, name: str) -> str:
        if name not in self.arguments:
            raise MissingArgumentError(name)
        return self.arguments[name]

    def _command(self, text: str) -> str:
        if text == "$(cwd)":
            return os.getcwd()  # noqa: PTH109 - a name, as xacro gives it
        substitution = SubstitutionArgs(
            packages=self.packages,
            environ=self.environ,
            folder=os.path.dirname(self.open_files[-1]),  # noqa: PTH120 - no links followed
            arguments=self.arguments,
        )
        return substitution.replace(text)

    def _load_yaml(self, name: str) -> Value:
        path = local_path(name, self.open_files[-1])
        self.budget.count_file()
        try:
            with self.reading_file(str(path)):
                return load_yaml(path, lambda text: self._expression(PropertyScope(), text))
        except InputError as error:
            raise UnresolvableError(str(error)) from None
