"""From the expressions of a plan to what judges messages by them."""

from collections.abc import Callable, Sequence

from rtron.errors import PlanError
from rtron.messages.common.definition_registry import DefinitionRegistry
from rtron.messages.common.encoding import Encoding
from rtron.messages.expressions.evaluator import MessageEvaluator
from rtron.policies.mission.rule_block import RuleResult
from rtron.vocabulary import MSRCN, Plan

EvaluateMessage = Callable[[bytes], Sequence[RuleResult]]
"""Judges a message by several expressions, in their order."""


class EvaluatorFactory:
    """Makes judges for the message types of a plan, with the areas and transforms of its MSRCN."""

    def __init__(self, plan: Plan, msrcn: MSRCN) -> None:
        self._definitions = DefinitionRegistry(plan.messages, ros=plan.ros)
        self._encoding = Encoding.ROS1 if plan.ros == 1 else Encoding.CDR
        self._msrcn = msrcn

    def create(
        self, type: str, subject: str, texts: Sequence[str], frames: Sequence[str]
    ) -> tuple[str, EvaluateMessage]:
        """Return the MD5 sum of `type`, and what judges its messages by `texts`.

        PlanError if the type is not known or an expression cannot be used.
        """
        definition = self._definitions.find(type)
        if definition is None:
            help = "add its text under `messages`; for ROS 2, source the workspace that has it"
            raise PlanError(f"no definition of {type or 'a type that is not named'}", help=help)
        evaluator = MessageEvaluator(
            definition,
            texts,
            subject=subject,
            encoding=self._encoding,
            areas=self._msrcn.areas,
            transforms=self._msrcn.transforms,
            frames=frames,
        )
        return definition.md5sum, evaluator.evaluate
