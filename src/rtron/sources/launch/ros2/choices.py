"""What a launch depends on: arguments and variables that decide names, files and what starts.

XML and YAML write them as the attributes `if` and `unless`. `python/actions.py` makes such
attributes of IfCondition and its kin in a Python file. `reader.py` runs or skips the action.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from rtron.sources.launch.ros2.element_site import ElementSite
from rtron.sources.launch.ros2.launch_context import LaunchVariable
from rtron.sources.launch.ros2.substitutions.template import first_placeholder, require_known
from rtron.sources.launch.ros2.xml_yaml import Element
from rtron.vocabulary import LaunchInput
from rtron.vocabulary.remap_rules import UNKNOWN_NAME
from rtron.wording import join_names

if TYPE_CHECKING:
    from rtron.sources.launch.ros2.evaluator import LaunchEvaluator


@dataclass(slots=True, kw_only=True)
class LaunchChoices:
    """Collects the sources of what was read; `arguments` and `environ` are those at the start.

    `declared` has a `*` where something was not read that may declare more arguments.
    """

    arguments: Mapping[str, str]
    environ: Mapping[str, str]
    _deciding: set[LaunchVariable] = field(default_factory=set)
    declared: set[str] = field(default_factory=set)
    _defaults: dict[str, set[str | None]] = field(default_factory=dict)

    def decide(self, variables: Iterable[LaunchVariable]) -> None:
        """Take note that the sources decide what starts, or a name, or a file."""
        self._deciding.update(variables)

    def skip(self, element: Element) -> None:
        """Take note of an action that does not run: what is declared in it is declared."""
        if element.tag == "arg":
            self.declared.add(element.plain_text("name"))
        elif element.tag == "include" or element.expand is not None:
            self.declared.add(UNKNOWN_NAME)
        else:
            for child in element.children:
                self.skip(child)

    def add_default(self, name: str, value: str | None) -> None:
        """Take note of what an argument is if it is not given; None for an unknown value."""
        self._defaults.setdefault(name, set()).add(value)

    def all(self) -> tuple[LaunchInput, ...]:
        """Return all that was decided."""
        return tuple(
            LaunchInput(name=s.name, values=self._values(s), environment=s.is_environment)
            for s in sorted(self._deciding)
        )

    def _values(self, variable: LaunchVariable) -> tuple[str | None, ...]:
        """Return the values that change nothing: to give an argument its default does not."""
        if variable.is_environment:
            return (self.environ.get(variable.name),)
        if variable.name in self.arguments:
            return (self.arguments[variable.name],)
        defaults = self._defaults.get(variable.name, set())
        return (None, *(defaults - {None} if len(defaults) == 1 else ()))


TRUE, FALSE = frozenset({"true", "1"}), frozenset({"false", "0"})


def evaluate_condition(
    evaluator: "LaunchEvaluator", site: ElementSite
) -> tuple[bool | None, frozenset[LaunchVariable]]:
    """Return what an element's condition says, None if it is not known, and what decides it."""
    results: list[bool | None] = []
    dependencies: set[LaunchVariable] = set()
    for key, expected in (("if", True), ("unless", False)):
        if site.has(key):
            results.append(None)
            text = evaluator.value(site, key)
            dependencies |= evaluator.dependencies
            with evaluator.collect_errors(site):
                results[-1] = None if text is None else parse_condition(text) is expected
    known = False if False in results else None if None in results else True
    return known, frozenset(dependencies)


def parse_condition(text: str) -> bool:
    """Return what a condition says; raise ValueError where launch would refuse it."""
    normalised = require_known(text).strip().lower()
    if normalised not in TRUE | FALSE:
        raise ValueError(f"'{text[:80]}' is neither true nor false")
    return normalised in TRUE


def note_unknown_condition(evaluator: "LaunchEvaluator", site: ElementSite) -> None:
    """Note that an action is read though it is not known whether its condition holds."""
    unknown, deciding = "refused", set[str]()
    for key in ("if", "unless"):
        text = evaluator.value(site, key) or ""
        unknown = first_placeholder(text) or unknown
        deciding |= {each.name for each in evaluator.dependencies} - {unknown}
    why = f"whether it counts is not known ({unknown}), it is read as if it did"
    hint = f"; what is given for {join_names(sorted(deciding))} may decide" if deciding else ""
    evaluator.note(site, why + hint)
