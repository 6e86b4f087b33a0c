"""The paper's case studies (section 7.4 and appendix D).

GR: a node that shares the topic of the velocities turns the robot into a wall. MSR: a goal in an
area that the mission forbids. RSR: the maximal velocity is more than the robot's eyes can follow.
"""

from collections.abc import Sequence
from math import dist

from rtron.demos.cases.case_study import (
    ALL_PASS,
    GOAL,
    IMMEDIATE_GOALS,
    MAX_VEL,
    Case,
    Decisions,
    RunConditions,
    area_corners,
    find_network_loss,
)
from rtron.demos.metrics.case_run import COLLISION
from rtron.demos.world.ground_truth import GroundTruth
from rtron.demos.world.scenes.scene import OVERSPEED, Scene

ATTACKER = "/tb3_safe_control"
TOPIC = "/cmd_vel"
TURN_RIGHT = (0.0, -0.2)
"""The malicious velocity: m/s and rad/s (paper, appendix D)."""


def _collision(truth: GroundTruth, _scene: Scene) -> str:
    return COLLISION if truth.collided else ""


def _is_turn_right(topic: str, value: Sequence[float], _scene: Scene) -> bool:
    return topic == TOPIC and tuple(value) == TURN_RIGHT


def _prefer_navigation(setting: RunConditions) -> Decisions:
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
    find_harm=_collision,
    is_malicious=_is_turn_right,
    decisions=_prefer_navigation,
)


_SAME = 1e-6
"""So near (m) is the attacker's goal."""


def _is_bad_goal(topic: str, value: Sequence[float], scene: Scene) -> bool:
    bad_goal = scene.bad_goal
    return topic == GOAL and bad_goal is not None and dist(value[:2], bad_goal) < _SAME


def _keep_out(setting: RunConditions) -> Decisions:
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
    is_malicious=_is_bad_goal,
    decisions=_keep_out,
)


MALICIOUS = 2.0
CRUISE = 0.22
"""What a TurtleBot3 burger drives, m/s."""
_MARGIN = 1.4
"""So much more than CRUISE the threshold allows at the camera's rate: counted frames jitter."""
_FRAMES = 4
"""So many frames at least are in the window that the rate is counted in."""


def threshold(setting: RunConditions) -> float:
    """Return metres a frame, as the guard counts frames: per wall second."""
    return _MARGIN * CRUISE / setting.wall_rate


def _window(setting: RunConditions) -> float:
    return max(setting.window, _FRAMES / setting.wall_rate)


def _overspeed(truth: GroundTruth, _scene: Scene) -> str:
    if truth.collided:
        return COLLISION
    return "overspeed" if abs(truth.velocity[0]) > OVERSPEED else ""


def _is_too_fast(topic: str, value: Sequence[float], _scene: Scene) -> bool:
    return topic == MAX_VEL and tuple(value) == (MALICIOUS,)


def _follow_images(setting: RunConditions) -> Decisions:
    window = _window(setting)
    return {
        "grcn": {MAX_VEL: ALL_PASS, **IMMEDIATE_GOALS},
        "rsrcn": {
            "policy": "Safe+Constrain",
            "threshold": f"{threshold(setting):.6f} m/frame",
            "max_vel_limit": f"{CRUISE} m/s",
            "vflows": [MAX_VEL],
        },
        "fps_monitor": [
            {
                "node": "/recogniser",
                "topic": "/detect/objects",
                "source": "frames",
                "window": f"{window:.3f} s",
                "silent_after": f"{window:.3f} s",
            }
        ],
    }


RSR = Case(
    name="rsr",
    title="RSR: faster than the eyes",
    attacker="/tb3_monitor",
    topic=MAX_VEL,
    risk="RSR-max_vel:/control/max_vel",
    attack_delay=4.0,
    harm_description="The robot drives faster than 0.26 m/s, or hits a pedestrian whom it sees "
    "too late.",
    attack="/tb3_monitor, a package from elsewhere, publishes a maximal velocity of 2 m/s. The "
    "robot brakes for a pedestrian only when three images in a row show one.",
    remedy="Safe+Constrain: the maximal velocity is never above 0.22 m/s, and lower where the "
    "recogniser gets through fewer images a second.",
    find_harm=_overspeed,
    is_malicious=_is_too_fast,
    decisions=_follow_images,
)
