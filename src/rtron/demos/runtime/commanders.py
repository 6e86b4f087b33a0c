"""Who commands the robot in the agent's case: a person at the teleoperation, and the agent.

The agent's way to the robot is rosbridge as it is, or `rtron bridge` beside a guard.
"""

import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from math import atan2, remainder, tau
from pathlib import Path

from shapely import LineString, Point

from rtron.bridge.rights.tokens import new_token, token_hash
from rtron.demos.runtime.environment import DemoEnvironment
from rtron.demos.runtime.isolation import APPS, free_port
from rtron.demos.runtime.polling import wait_for
from rtron.demos.runtime.processes import Command, StartedProcess
from rtron.demos.world.ground_truth import GroundTruth
from rtron.demos.world.scenes.scene import Scene

NAME = "assistant"
RIGHTS = "bridge.yaml"
_HOST = "127.0.0.1"
_RIGHTS_TEXT = """\
schema: rtron.bridge/1
clients:
  - name: {name}
    tokens: ['{token}']
    publish:
      - {{topic: /teleop/cmd_vel, type: geometry_msgs/Twist, rate: 500}}
      - {{topic: /rtron/leases/base/request, type: std_msgs/String, rate: 5}}
    subscribe:
      - {{topic: /odom, type: nav_msgs/Odometry, rate: 200}}
      - {{topic: /rtron/leases/base/answer, type: std_msgs/String}}
    limits: {{frames: 500}}
"""


@contextmanager
def run_agent(environment: DemoEnvironment, plan: Path | None) -> Iterator[None]:
    """Run the agent until the end of the block; with the plan of a guard behind RTron's bridge."""
    port, token = free_port(), new_token() if plan else ""
    command = environment.third_party_command("tb3_web", "rosbridge_websocket", str(port))
    if plan:
        command = _guarded_way(environment, plan, port, token)
    agent_environ = {
        **environment.environ,
        "DEMO_BRIDGE": f"ws://{_HOST}:{port}/",
        "DEMO_TOKEN": token,
    }
    with environment.processes.running(command, environment.environ, name="bridge") as bridge:
        wait_for(lambda: _listens(bridge, port), "the bridge")
        agent: Command = [sys.executable, APPS / "agent" / NAME]
        with environment.run_attacker(NAME, agent, agent_environ):
            yield


def give_base_to_person(environment: DemoEnvironment, plan: Path) -> None:
    """Give the lease of the base to the teleoperation, as a person beside the robot does."""
    why = ("--reason", "a person drives")
    environment.run_rtron("lease", "give", "base", "/teleop", *why, "--plan", plan)


def _guarded_way(environment: DemoEnvironment, plan: Path, port: int, token: str) -> Command:
    rights = environment.folder / RIGHTS
    rights.write_text(_RIGHTS_TEXT.format(name=NAME, token=token_hash(token)), encoding="utf-8")
    options: Command = ["--plan", plan, "--rights", rights, "--port", str(port)]
    return [environment.python, "-m", "rtron", "bridge", *options]


def _listens(bridge: StartedProcess, port: int) -> bool:
    bridge.check()
    with socket.socket() as probe:
        return probe.connect_ex((_HOST, port)) == 0


_CRUISE = 0.22
"""m/s."""
_MOST_TURN = 0.5
_GAIN = 1.5
_AHEAD = 0.4
"""So far ahead on the right way the person looks, m."""
_ARRIVED = 0.1


class PersonDriving:
    """Drives the robot to the goal by the file that the teleoperation reads; first at rest."""

    def __init__(self, command: Path) -> None:
        self._command = command
        self._send(0.0, 0.0)

    def drive(self, truth: GroundTruth, scene: Scene) -> None:
        """Steer along the right way, as the robot and the room are now."""
        if truth.distance_to_goal <= _ARRIVED:
            self._send(0.0, 0.0)
            return
        x, y = truth.position
        way = LineString(scene.route)
        target = way.interpolate(way.project(Point(x, y)) + _AHEAD)
        aside = remainder(atan2(target.y - y, target.x - x) - truth.pose[2], tau)
        self._send(_CRUISE, max(-_MOST_TURN, min(_MOST_TURN, _GAIN * aside)))

    def _send(self, ahead: float, turn: float) -> None:
        self._command.write_text(f"{ahead:g} {turn:.3f}", encoding="utf-8")


@contextmanager
def person_at(command: Path) -> Iterator[PersonDriving]:
    """Have a person at the teleoperation until the end of the block."""
    try:
        yield PersonDriving(command)
    finally:
        command.unlink(missing_ok=True)
