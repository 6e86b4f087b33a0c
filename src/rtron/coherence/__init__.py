"""The checks of a plan, and of a plan with settings in force: for planning, guard and service."""

from rtron.coherence.effective_plan import (
    EffectivePlan,
    SettingsMismatchError,
    compatible_settings,
    coordination_node_ids,
)
from rtron.coherence.flows import CoherenceProblem, guards_nothing
from rtron.coherence.plan_changes import relaunch_reasons
from rtron.coherence.plan_checks import coherence_problems

__all__ = [
    "CoherenceProblem",
    "EffectivePlan",
    "SettingsMismatchError",
    "coherence_problems",
    "compatible_settings",
    "coordination_node_ids",
    "guards_nothing",
    "relaunch_reasons",
]
