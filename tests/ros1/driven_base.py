"""A base that is driven: navigation, attackers and a C++ driver, with and without the guard."""

import shutil

from harness import NODES, wait_for
from plans import grcn, plan_of

from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import SECOND, Domain, Flow, PolicyName, StreamKind

TURN_RIGHT, TURN_LEFT = "-0.2", "0.5"
PATIENCE = 3 * SECOND
"""How long a flow keeps the driver without a word: a busy machine is not a silent node."""
CMD_VEL = "/cmd_vel"
CMD_VEL_GUARD = "/rtron/grcn_cmd_vel"
MAP_GUARD = "/rtron/grcn_map"


def drive_plan():
    """Return the plan: navigation goes before the rogue, on the way to the driver."""
    flows = (
        Flow(name="flow1", publisher="/nav", priority=2, silent_after=PATIENCE),
        Flow(name="flow2", publisher="/rogue", priority=1, silent_after=PATIENCE),
    )
    return plan_of(grcn(CMD_VEL, (), ["/driver"], flows=flows, release_after=PATIENCE), app="base")


def map_plan():
    """Return a plan whose GRCN lets the map server's state through."""
    state = grcn(
        "/map",
        ["/map_server"],
        ["/planner"],
        type="nav_msgs/OccupancyGrid",
        domain=Domain.PLANNING,
        kind=StreamKind.STATE,
        policy=PolicyName.BLOCK,
    )
    return plan_of(state, app="map")


class Driven:
    """What the driver was told, message by message."""

    def __init__(self, path):
        self.path = path

    def messages(self):
        """Return each message as (linear.x, angular.z)."""
        return [(x, turn) for x, turn, *_ in self._lines()]

    def speeds_of_senders(self):
        """Return each message as (its node, linear.x); driver.cpp does not tell the node."""
        return [(sender, float(x)) for x, _, sender in self._lines()]

    def _lines(self):
        text = self.path.read_text() if self.path.exists() else ""
        whole = text[: text.rfind("\n") + 1]
        return [line.split() for line in whole.splitlines()]

    def navigation(self):
        """Return the counts that navigation sent, in order of arrival."""
        return [round(float(x) * 1000) for x, turn in self.messages() if turn == TURN_LEFT]

    def assert_navigation_is_whole(self):
        """Assert that navigation has arrived from its first on, in order.

        Who waits for a processor may be taken for gone: what navigation says while others slow the
        robot down is not heard.
        """
        last, is_slowed = -1, False
        for speed, turn in self.messages():
            if turn == TURN_LEFT:
                count = round(float(speed) * 1000)
                assert count > last if is_slowed else count == last + 1, (last, count)
                last, is_slowed = count, False
            else:
                is_slowed = True

    def turns(self):
        """Return how many messages of the attackers arrived."""
        return sum(turn == TURN_RIGHT for _, turn in self.messages())

    def turns_after_navigation_began(self):
        messages = self.messages()
        began = next((n for n, (_, turn) in enumerate(messages) if turn == TURN_LEFT), 0)
        return sum(turn == TURN_RIGHT for _, turn in messages[began:])


class Base:
    """The nodes of the driven base on a master; `guarded` wires them as the guarded launch does."""

    def __init__(self, ros1, driver, *, guarded):
        self.ros1 = ros1
        self.guarded = guarded
        self.driven = Driven(ros1.folder / "driven.txt")
        if guarded:
            start_guard(ros1, drive_plan(), CMD_VEL_GUARD)
        ros1.spawn(driver, self.driven.path, "__name:=driver", *self._remap("out"))
        ros1.wait_for_nodes("/driver")
        wait_for(lambda: ros1.subscribers(self.topic("out")), what="the driver's subscription")

    def topic(self, end):
        """Return what /cmd_vel is called at one end: a flow's name, or `out`."""
        return f"/rtron{CMD_VEL}/{end}" if self.guarded else CMD_VEL

    def navigate(self):
        """Start navigation and wait until the driver has heard of it."""
        nav = self.ros1.node("nav.py", "/nav", *self._remap("flow1"))
        wait_for(self.driven.navigation, what="navigation at the driver")
        return nav

    def attack(self, rate):
        """Start the approved node that turns rogue."""
        return self.ros1.node("rogue.py", "/rogue", str(rate), *self._remap("flow2"))

    def attack_by_hand(self, rate):
        """Start a node that the plan does not know; it publishes under the public name."""
        return self.ros1.node("rogue.py", "/by_hand", str(rate))

    def wait_for_blocked(self, topic, count):
        """Wait until the guard has received so many messages of attackers on a topic."""
        what = f"{count} messages on {topic}"
        wait_for(lambda: self.ros1.received(CMD_VEL_GUARD, topic) >= count, what=what)

    def wait_for_navigation(self):
        """Wait until all that navigation has sent so far has arrived."""
        sent = self.ros1.sent("/nav", self.topic("flow1"))
        assert sent > 0
        wait_for(lambda: len(self.driven.navigation()) >= sent, what="what navigation sent")

    def _remap(self, end):
        return (f"{CMD_VEL}:={self.topic(end)}",) if self.guarded else ()


def start_guard(ros1, plan, node, *more):
    """Start `rtron guard` with a plan and wait for its node."""
    path = ros1.folder / "rtron.yaml"
    path.write_text(write_plan(plan))
    guard = ros1.rtron("guard", "--plan", path, *more)
    ros1.wait_for_nodes(node)
    return guard


LAUNCH = """<launch>
  <arg name="out"/>
  <node pkg="base" type="driver" name="driver" args="$(arg out)" required="true"/>
  <node pkg="base" type="nav.py" name="nav"/>
  <node pkg="base" type="rogue.py" name="rogue" args="1000"/>
</launch>
"""


def write_app(folder, driver):
    """Write the base as a package with a launch file; return the launch file."""
    package = folder / "base"
    package.mkdir()
    (package / "package.xml").write_text("<package><name>base</name></package>")
    for program in (driver, NODES / "nav.py", NODES / "rogue.py"):
        shutil.copy(program, package)
    launch = package / "base.launch"
    launch.write_text(LAUNCH)
    return launch
