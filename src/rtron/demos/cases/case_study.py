"""A case: what the attack is, what harm is, and what the developer decides against it."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from rtron.demos.metrics.case_run import COLLISION
from rtron.demos.world.ground_truth import GroundTruth
from rtron.demos.world.scenes.scene import Scene

Decisions = Mapping[str, Any]
"""What the developer changes in the proposed plan, as `rtron.demos.runtime` applies it."""

GOAL = "/move_base_simple/goal"
ALL_PASS = {"policy": "Block"}
"""Of a GRCN that lets all nodes of the plan pass, since none is blocked; strangers do not pass."""
IMMEDIATE_GOALS = {GOAL: ALL_PASS}
"""A new goal replaces the last, and does not wait for it to be reached."""
MAX_VEL = "/control/max_vel"
_REPEATED = 3.0
"""Simulated s: three times the period in which the maximal velocity is told."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RunConditions:
    """What the decisions depend on: the world's scene and speed, and the camera's rate.

    `rate` is in images a simulated second. The guard's clock is that of the wall, in which a
    world of speed 3 shows it three times as many; `window` (wall s) is how long it counts them.
    """

    scene: Scene
    speed: float
    rate: float
    window: float = 0.3

    @property
    def max_velocity_hold(self) -> Decisions:
        """Of the maximal velocity's GRCN: who tells one stays in control until the next."""
        return {MAX_VEL: {"release_after": f"{_REPEATED / self.speed:g} s"}}

    @property
    def wall_rate(self) -> float:
        """Images a wall second."""
        return self.rate * self.speed


@dataclass(frozen=True, slots=True, kw_only=True)
class Case:
    """One of the paper's three case studies (section 7.4 and appendix D), or the agent's.

    `find_harm` names the harm in a sample of a scene, "" for none; `is_malicious` recognises a
    malicious message of a scene by its topic and value, where it arrives. The attack begins when
    the robot has moved for `attack_delay` simulated s. With `has_manual_attacker` a second attacker
    starts under another name; `over_bridge` says that a person drives, and the attacker is an agent
    over a bridge; `shows_turn_rate` says that the turn rate shows the attack, too.
    The texts are for people, each a sentence or two; `remedy` explains the plan.
    """

    name: str
    title: str
    attacker: str
    topic: str
    risk: str
    attack_delay: float
    has_manual_attacker: bool = False
    over_bridge: bool = False
    shows_turn_rate: bool = False
    harm_description: str
    attack: str
    remedy: str
    find_harm: Callable[[GroundTruth, Scene], str]
    is_malicious: Callable[[str, Sequence[float], Scene], bool]
    decisions: Callable[[RunConditions], Decisions]


def find_network_loss(truth: GroundTruth, _scene: Scene) -> str:
    """Name the harm where a robot must not come into the area without network."""
    if truth.collided:
        return COLLISION
    return "network lost" if truth.in_area else ""


def area_corners(setting: RunConditions) -> Sequence[Mapping[str, str]]:
    """Return the corners of the area without network as a plan has them."""
    return [{"x": f"{x:g} m", "y": f"{y:g} m"} for x, y in setting.scene.area or ()]


def merge_decisions(decisions_of_cases: Iterable[Decisions]) -> Decisions:
    """Return what is decided in any of them; of a topic's GRCN, all that is said of it.

    The MSRCN has the topics, areas, events and rules of all of them.
    """
    found: Decisions = {}
    for decisions in decisions_of_cases:
        known = found.get("grcn", {})
        grcn_decisions = {
            topic: {**known.get(topic, {}), **of} for topic, of in decisions["grcn"].items()
        }
        msrcn = _joined(found.get("msrcn", {}), decisions.get("msrcn", {}))
        merged = {"grcn": {**known, **grcn_decisions}, **({"msrcn": msrcn} if msrcn else {})}
        found = {**found, **decisions, **merged}
    return found


def _joined(one: Decisions, other: Decisions) -> Decisions:
    """Return lists with the entries of both, in an order that does not depend on theirs."""
    return {
        name: sorted([*one.get(name, ()), *other.get(name, ())], key=str)
        for name in sorted(one.keys() | other.keys())
    }
