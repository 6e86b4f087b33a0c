"""MSR: a goal in an area that the mission forbids."""

from collections.abc import Sequence
from math import dist

from rtron.demos.cases.case_study import (
    GOAL,
    IMMEDIATE_GOALS,
    Case,
    Decisions,
    RunConditions,
    area_corners,
    find_network_loss,
)
from rtron.demos.world.scenes.scene import Scene

_SAME = 1e-6


def _is_malicious(topic: str, value: Sequence[float], scene: Scene) -> bool:
    bad_goal = scene.bad_goal
    return topic == GOAL and bad_goal is not None and dist(value[:2], bad_goal) < _SAME


def _decisions(setting: RunConditions) -> Decisions:
    return {
        "grcn": {**IMMEDIATE_GOALS, **setting.max_velocity_hold},
        "msrcn": {
            "aflows": [GOAL],
            "areas": [{"name": "unstable", "frame": "map", "polygon": area_corners(setting)}],
            "rules": [
                {
                    "name": "keep_out",
                    "action": "inside(action.pose.position, unstable)",
                    "block": [GOAL],
                    "reason": "there is no network in the unstable area",
                }
            ],
        },
    }


MSR = Case(
    name="msr",
    title="MSR: a goal where the mission forbids one",
    attacker="/tb3_monitor",
    topic=GOAL,
    risk="MSR-action:/move_base_simple/goal",
    attack_delay=4.0,
    harm_description="The robot drives into the area without network and stays there.",
    attack="/tb3_monitor, a package from elsewhere, publishes a goal of its own in the middle of "
    "the drive: a place where the network, and with it the computer that plans, is out of reach.",
    remedy="A rule with Block: no goal inside the unstable area, whoever asks for it.",
    find_harm=find_network_loss,
    is_malicious=_is_malicious,
    decisions=_decisions,
)
