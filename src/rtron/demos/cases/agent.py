"""AGENT: an agent behind a bridge, talked into a short cut, while a person drives."""

from collections.abc import Sequence

from rtron.demos.cases.case_study import (
    IMMEDIATE_GOALS,
    Case,
    Decisions,
    RunConditions,
    area_corners,
    find_network_loss,
)
from rtron.demos.world.scenes.scene import Scene

ATTACKER = "/bridge/assistant"
TOPIC = "/teleop/cmd_vel"
_PERSON = "/teleop"
_AT_BASE = "/cmd_vel"
_FAST, _TURN = 0.8, 1.2
"""What the agent sends and nobody else, m/s and rad/s."""


def _is_malicious(topic: str, value: Sequence[float], _scene: Scene) -> bool:
    return topic == _AT_BASE and (value[0] == _FAST or abs(value[1]) == _TURN)


def _decisions(setting: RunConditions) -> Decisions:
    ranks = {_PERSON: {"rank": "operator_on_site"}, ATTACKER: {"rank": "agent"}}
    return {
        "clients": {TOPIC: [ATTACKER]},
        "leases": [{"name": "base", "ttl": "10 min"}],
        "grcn": {
            TOPIC: {"policy": "Lease", "lease": "base", "flows": ranks},
            **IMMEDIATE_GOALS,
            **setting.max_velocity_hold,
        },
        "msrcn": {
            "aflows": [TOPIC],
            "areas": [{"name": "no_network", "frame": "odom", "polygon": area_corners(setting)}],
            "eflows": [
                {
                    "name": "in_area",
                    "topic": "/odom",
                    "publisher": "/turtlebot3_core",
                    "type": "nav_msgs/Odometry",
                    "when": "inside(event.pose.pose.position, no_network)",
                    "max_age": "2 s",
                }
            ],
            "rules": [
                {
                    "name": "no_driving_without_network",
                    "when": "in_area",
                    "block": [TOPIC],
                    "reason": "there is no network where the robot is",
                }
            ],
        },
        "incidents": {"keep": "20 s", "after": "2 s"},
    }


AGENT = Case(
    name="agent",
    title="AGENT: an agent that is talked into a short cut",
    attacker=ATTACKER,
    topic=TOPIC,
    risk=f"MSR-action:{TOPIC}",
    attack_delay=3.0,
    over_bridge=True,
    harm_description="The robot speeds into the area without network and stays there.",
    attack="A person drives the robot by teleoperation. An assistant is connected to rosbridge, "
    "where whoever connects may drive. It reads a note that says that the person is too slow, and "
    "takes the robot at 0.8 m/s through the area without network.",
    remedy="The assistant comes over `rtron bridge` with a token, as a flow of its own under a "
    "lease. The person has the lease, and an agent cannot take it from a person.",
    find_harm=find_network_loss,
    is_malicious=_is_malicious,
    decisions=_decisions,
)
