"""The conditions of actions, in all three formats (docs.ros.org: launch, conditions).

XML and YAML write them as the attributes `if` and `unless`. `python/actions.py` makes such
attributes of IfCondition and its kin in a Python file. `reader.py` runs or skips the action.
"""

from typing import TYPE_CHECKING

from rtron.sources.launch.ros2.element_site import ElementSite
from rtron.sources.launch.ros2.launch_context import LaunchVariable
from rtron.sources.launch.ros2.substitutions.template import first_placeholder, require_known
from rtron.wording import join_names

if TYPE_CHECKING:
    from rtron.sources.launch.ros2.evaluator import LaunchEvaluator

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
