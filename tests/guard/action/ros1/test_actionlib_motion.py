"""A server as move_base is one: it drives while it has a goal, and takes goals without an id, too.

It is wired as the guarded launch does it: what it publishes and hears has the name of its flow.
"""

from dataclasses import replace

import pytest
from action_app import ACT, ANSWERED, ASKED, GUARD, SERVER, Act, Server, action_plan
from driven_base import CMD_VEL, CMD_VEL_GUARD, Driven
from harness import wait_for
from plans import grcn
from traffic_light import Light, ruled

from rtron.vocabulary import SECOND, PolicyName, StreamKind

pytestmark = pytest.mark.ros1
LONG = 60_000
POSES = f"{ACT}_simple/goal"
POSES_GUARD = "/rtron/grcn_act_simple_goal"
OWN = f"/rtron{ACT}/goal/flow2"
CLIENTS = ("/one", SERVER)
WIRING = [
    *(f"{ACT}/{part}:=/rtron{ACT}/{part}/flow2" for part in ASKED),
    *(f"{ACT}/{part}:=/rtron{ACT}/{part}/server" for part in ANSWERED),
    f"{POSES}:=/rtron{POSES}/out",
    f"{CMD_VEL}:=/rtron{CMD_VEL}/flow1",
]


def driving_plan():
    """Return a plan of the action and of the velocities; the red light blocks the action."""
    plan = action_plan(PolicyName.FIFO_QUEUE, CLIENTS)
    velocities = grcn(CMD_VEL, [SERVER], ["/driver"])
    return ruled(replace(plan, grcn=(*plan.grcn, velocities)), f"{ACT}/goal")


def poses_plan():
    """Return a plan of the action and of goals without an id, which the red light blocks."""
    plan = action_plan(PolicyName.FIFO_QUEUE, CLIENTS)
    settings = {"policy": PolicyName.FIFO_QUEUE, "max_age": 60 * SECOND, "done": f"{ACT}/result"}
    poses = grcn(
        POSES,
        ["/giver", "/other"],
        [SERVER],
        type="geometry_msgs/PoseStamped",
        kind=StreamKind.ACTION,
        **settings,
    )
    return ruled(replace(plan, grcn=(*plan.grcn, poses)), POSES)


class Base:
    """The server, which ends a cancelled goal only once it may, and a client."""

    def __init__(self, ros1, programs, plan):
        self.ros1 = ros1
        act = Act(ros1, programs, plan)
        self.light = Light(ros1, "green")
        self._may_end = ros1.folder / "may_end"
        self.served = Server(ros1.folder / "server.txt")
        ros1.node("base_server.py", SERVER, self.served.path, self._may_end, *WIRING)
        self.one = act.client(name="/one")
        self.one.wait_for("connected")
        for listener in (GUARD, SERVER):
            wait_for(lambda at=listener: ros1.connected(SERVER, at, OWN), what=f"{OWN} {listener}")

    def let_end(self):
        self._may_end.touch()


@pytest.fixture
def driving(ros1, programs):
    """Return a base that drives, and what its driver is told."""
    driven = Driven(ros1.folder / "driven.txt")
    ros1.node("driver.py", "/driver", driven.path, f"{CMD_VEL}:=/rtron{CMD_VEL}/out")
    return Base(ros1, programs, driving_plan()), driven


def speeds(driven):
    return [float(x) for x, _ in driven.messages()]


def test_a_rule_stops_the_robot_that_a_cancelled_goal_still_drives(ros1, driving):
    base, driven = driving
    base.one.send(LONG)
    wait_for(lambda: 1 in speeds(driven), what="the first goal's velocity")
    base.light.turn("red")
    wait_for(lambda: 0 in speeds(driven), what="the stop")
    spoken = ros1.received(CMD_VEL_GUARD, f"/rtron{CMD_VEL}/flow1")
    wait_for(
        lambda: ros1.received(CMD_VEL_GUARD, f"/rtron{CMD_VEL}/flow1") >= spoken + 20,
        what="velocities after the stop",
    )
    assert not base.one.of("done")
    base.let_end()
    assert base.one.done(1) == {1: "PREEMPTED"}
    base.light.turn("green")
    base.one.send(LONG)
    wait_for(lambda: 2 in speeds(driven), what="the second goal's velocity")
    assert_stopped_between(driven.speeds_of_senders())


def assert_stopped_between(told):
    """Assert that the robot was slowed down to a stop, and nothing but the next goal moved it.

    A supervisor whose guard is late stops the robot, too; what the two send may cross on the way.
    """
    speeds = [speed for _, speed in told]
    moved = told[speeds.index(1) : speeds.index(2)]
    assert moved[0][1] == 1
    assert moved[-1][1] == 0
    for sender in {sender for sender, _ in moved}:
        slowed = [speed for each, speed in moved if each == sender]
        assert slowed == sorted(slowed, reverse=True)
    assert set(speeds[speeds.index(2) :]) == {2}


class Poses(Base):
    """A base that takes goals without an id from two nodes."""

    def __init__(self, ros1, programs):
        super().__init__(ros1, programs, poses_plan())
        self._numbers = {name: self._giver(n, name) for n, name in enumerate(("giver", "other"), 1)}
        self.let_end()

    def give(self, name, number):
        """Let a node give a goal; return once the guard has got it."""
        topic = f"/rtron{POSES}/{'flow1' if name == 'giver' else 'flow2'}"
        heard = self.ros1.received(POSES_GUARD, topic)
        with self._numbers[name].open("a") as file:
            file.write(f"{number}\n")
        wait_for(lambda: self.ros1.received(POSES_GUARD, topic) > heard, what=f"{name}'s goal")

    def started(self, count):
        """Wait until so many goals have started; return their numbers."""
        return [int(line.words[1]) for line in self.served.wait_for("started", count)]

    def assert_one_after_the_other(self, count):
        """Assert that each goal was done before the next started, and none was cancelled."""
        self.served.wait_for("done", count)
        did = [line.what for line in self.served.all("started", "done", "cancelled")]
        assert did == ["started", "done"] * count

    def _giver(self, n, name):
        numbers = self.ros1.folder / f"{name}.numbers"
        numbers.touch()
        self.ros1.node("pose_publisher.py", f"/{name}", numbers, f"{POSES}:=/rtron{POSES}/flow{n}")
        topic = f"/rtron{POSES}/flow{n}"
        wait_for(lambda: self.ros1.connected(f"/{name}", POSES_GUARD, topic), what=name)
        return numbers


@pytest.fixture
def poses(ros1, programs):
    return Poses(ros1, programs)


@pytest.mark.long
def test_a_second_goal_without_an_id_waits_until_the_first_is_over(poses):
    poses.give("giver", 2500)
    assert poses.started(1) == [2500]
    poses.give("other", 20)
    assert poses.started(2) == [2500, 20]
    poses.assert_one_after_the_other(2)


@pytest.mark.long
def test_a_goal_of_the_action_waits_until_one_without_an_id_is_over(poses):
    poses.give("giver", 2500)
    assert poses.started(1) == [2500]
    poses.one.send(20)
    poses.one.wait_for_state(1, "PENDING")
    assert poses.one.done(1) == {1: "SUCCEEDED"}
    assert poses.started(2) == [2500, 20]
    poses.assert_one_after_the_other(2)


@pytest.mark.long
def test_goals_of_both_kinds_that_wait_go_one_after_the_other(poses):
    poses.give("giver", 2500)
    assert poses.started(1) == [2500]
    poses.give("other", 300)
    poses.one.send(300)
    assert poses.one.done(1) == {1: "SUCCEEDED"}
    assert poses.started(3) == [2500, 300, 300]
    poses.assert_one_after_the_other(3)


@pytest.mark.long
def test_a_goal_without_an_id_waits_for_a_goal_of_the_action(poses):
    poses.one.send(2500)
    assert poses.started(1) == [2500]
    poses.give("giver", 20)
    assert poses.one.done(1) == {1: "SUCCEEDED"}
    assert poses.started(2) == [2500, 20]
    poses.assert_one_after_the_other(2)


@pytest.mark.long
def test_a_rule_cancels_the_goal_that_one_without_an_id_has_become(poses):
    poses.give("giver", LONG)
    assert poses.started(1) == [LONG]
    poses.light.turn("red")
    (cancelled,) = poses.served.wait_for("cancelled")
    assert cancelled.words == poses.served.of("started")[0]


@pytest.mark.long
def test_a_goal_that_a_rule_has_cancelled_gives_its_turn_to_the_next(poses):
    poses.give("giver", LONG)
    assert poses.started(1) == [LONG]
    poses.light.turn("red")
    poses.served.wait_for("cancelled")
    poses.give("other", LONG)
    poses.light.turn("green")
    poses.give("other", 20)
    poses.served.wait_for("done", limit_s=15)
    assert poses.started(2) == [LONG, 20]
