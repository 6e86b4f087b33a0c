"""The conditions of actions, in all three formats (docs.ros.org: launch, conditions).

XML and YAML write them as the attributes `if` and `unless`. `python/actions.py` makes such
attributes of IfCondition and its kin in a Python file. `reader.py` runs or skips the action.
"""

from typing import TYPE_CHECKING

from rtron.sources.launch.ros2.element_site import ElementSite
from rtron.sources.launch.ros2.launch_context import LaunchVariable
from rtron.sources.launch.ros2.substitutions.template import require_known

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
