"""GR: a node that shares the topic of the velocities turns the robot into a wall."""

from collections.abc import Sequence

from rtron.demos.cases.case_study import IMMEDIATE_GOALS, Case, Decisions, RunConditions
from rtron.demos.metrics.case_run import COLLISION
from rtron.demos.world.ground_truth import GroundTruth
from rtron.demos.world.scenes.scene import Scene

ATTACKER = "/tb3_safe_control"
TOPIC = "/cmd_vel"
TURN_RIGHT = (0.0, -0.2)
"""The malicious velocity: m/s and rad/s (paper, appendix D)."""


def _harm(truth: GroundTruth, _scene: Scene) -> str:
    return COLLISION if truth.collided else ""


def _is_malicious(topic: str, value: Sequence[float], _scene: Scene) -> bool:
    return topic == TOPIC and tuple(value) == TURN_RIGHT


def _decisions(setting: RunConditions) -> Decisions:
    return {
        "grcn": {
            TOPIC: {
                "policy": "Preemption",
                "flows": {"/move_base": {"priority": 2}, ATTACKER: {"priority": 1}},
                "block_unapproved": True,
            },
            **IMMEDIATE_GOALS,
            **setting.max_velocity_hold,
        }
    }


GR = Case(
    name="gr",
    title="GR: two nodes share one topic",
    attacker=ATTACKER,
    topic=TOPIC,
    risk="GR-ST:/cmd_vel",
    attack_delay=5.0,
    has_manual_attacker=True,
    shows_turn_rate=True,
    harm_description="The robot hits the corridor's wall.",
    attack="While /move_base drives through a corridor, /tb3_safe_control, a package from "
    "elsewhere, floods /cmd_vel with turns to the right. Its script, started by hand under "
    "another name, does the same on the public topic.",
    remedy="Preemption: /move_base goes before /tb3_safe_control, which drives only while the "
    "navigation is silent. Whom the plan does not name is blocked.",
    find_harm=_harm,
    is_malicious=_is_malicious,
    decisions=_decisions,
)
