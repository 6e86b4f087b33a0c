"""RSR: the maximal velocity is set to more than the robot's eyes can follow."""

from collections.abc import Sequence

from rtron.demos.cases.case_study import (
    ALL_PASS,
    IMMEDIATE_GOALS,
    MAX_VEL,
    Case,
    Decisions,
    RunConditions,
)
from rtron.demos.metrics.case_run import COLLISION
from rtron.demos.world.ground_truth import GroundTruth
from rtron.demos.world.scenes.scene import OVERSPEED, Scene

TOPIC = MAX_VEL
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


def _harm(truth: GroundTruth, _scene: Scene) -> str:
    if truth.collided:
        return COLLISION
    return "overspeed" if abs(truth.velocity[0]) > OVERSPEED else ""


def _is_malicious(topic: str, value: Sequence[float], _scene: Scene) -> bool:
    return topic == TOPIC and tuple(value) == (MALICIOUS,)


def _decisions(setting: RunConditions) -> Decisions:
    window = _window(setting)
    return {
        "grcn": {TOPIC: ALL_PASS, **IMMEDIATE_GOALS},
        "rsrcn": {
            "policy": "Safe+Constrain",
            "threshold": f"{threshold(setting):.6f} m/frame",
            "max_vel_limit": f"{CRUISE} m/s",
            "vflows": [TOPIC],
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
    topic=TOPIC,
    risk="RSR-max_vel:/control/max_vel",
    attack_delay=4.0,
    harm_description="The robot drives faster than 0.26 m/s, or hits a pedestrian whom it sees "
    "too late.",
    attack="/tb3_monitor, a package from elsewhere, publishes a maximal velocity of 2 m/s. The "
    "robot brakes for a pedestrian only when three images in a row show one.",
    remedy="Safe+Constrain: the maximal velocity is never above 0.22 m/s, and lower where the "
    "recogniser gets through fewer images a second.",
    find_harm=_harm,
    is_malicious=_is_malicious,
    decisions=_decisions,
)
