"""Poses through the guard to a real server of ROS 2 that makes a goal of its own of each."""

from dataclasses import replace

import pytest

pytest.importorskip("rclpy", reason="needs ROS 2")
from geometry_msgs.msg import PoseStamped
from harness import wait_for
from plans import grcn, plan_of
from rclpy.action import ActionClient
from ros2_action_app import (
    ACTION,
    ONE,
    SERVER,
    TWO,
    GuardThread,
    Participant,
    RclpyActionApp,
    Server,
)
from test_msgs.action import Fibonacci

from rtron.vocabulary import SECOND, Flow, PolicyName, StreamKind, flow_topic, output_topic

pytestmark = pytest.mark.ros2
GOAL_POSE, THREE = "/goal_pose", "/three"
ACTION_FLOWS = (Flow(name="flow1", publisher=THREE),)
POSES = grcn(
    GOAL_POSE,
    [ONE, TWO],
    [SERVER],
    type="geometry_msgs/msg/PoseStamped",
    kind=StreamKind.ACTION,
    policy=PolicyName.FIFO_QUEUE,
    max_age=60 * SECOND,
    done=ACTION,
)


class PoseServer(Server):
    """A server that asks itself for the goal n when it hears a pose at x = n, as Nav2 does."""

    def __init__(self, domain, action):
        super().__init__(domain, action=action)
        self._own = ActionClient(self.node, Fibonacci, action)
        self.poses = self.node.create_subscription(
            PoseStamped, output_topic(GOAL_POSE), self._hear, 10
        )

    def _hear(self, pose):
        self._own.send_goal_async(Fibonacci.Goal(order=int(pose.pose.position.x)))


class PosePublisher(Participant):
    """Gives poses to the guard."""

    def __init__(self, domain, name, flow):
        super().__init__(name, domain)
        self.end = self.node.create_publisher(PoseStamped, flow_topic(GOAL_POSE, flow), 10)
        self.start()

    def publish_pose(self, x):
        pose = PoseStamped()
        pose.pose.position.x = float(x)
        self.end.publish(pose)


class PoseApp(RclpyActionApp):
    """Two who give poses, a server, and the guard between them, of the action too if asked to."""

    def __init__(self, domain, *, guarded):
        self.guarded = guarded
        super().__init__(domain)

    def _start(self):
        asked = (replace(each, flows=ACTION_FLOWS) for each in self.plan.grcn if self.guarded)
        self.plan = plan_of(POSES, *asked, ros=2)
        action = output_topic(ACTION) if self.guarded else ACTION
        self.server = self.keep(PoseServer(self.domain, action))
        self.guard = self.keep(GuardThread(self.domain, self.plan))
        self.one = self.keep(PosePublisher(self.domain, ONE, "flow1"))
        self.two = self.keep(PosePublisher(self.domain, TWO, "flow2"))
        wait_for(self._found, what="all to find each other")

    def _found(self):
        heard = all(each.end.get_subscription_count() for each in (self.one, self.two))
        hears = self.server.poses.get_publisher_count()
        streams = self.guard.coordinator.streams
        served = streams[1].server.is_available if self.guarded else streams[0]._observer.sees_goals
        return heard and hears and served


def test_poses_go_one_by_one_and_a_block_cancels_the_goal_they_became(start_action_app):
    app = start_action_app(kind=PoseApp, guarded=False)
    app.one.publish_pose(1)
    wait_for(lambda: app.server.started == [1], what="the first pose's goal")
    app.two.publish_pose(2)
    wait_for(lambda: app.guard.held("flow2") == 1, what="the second pose to wait")
    assert app.server.started == [1]
    app.server.finish(1)
    wait_for(lambda: app.server.started == [1, 2], what="the second pose's goal")

    def block():
        app.guard.action.pipeline.bar("a test", ["flow2"], "an area is closed")
        app.guard.coordinator.recheck()

    app.guard.call(block)
    wait_for(lambda: app.server.ended == [1, 2], what="the end of what was cancelled")
    assert app.server.cancels == [2]


def test_poses_and_goals_of_a_guarded_action_take_turns(start_action_app):
    app = start_action_app(kind=PoseApp, guarded=True)
    client = app.client(THREE, "flow1")
    app.one.publish_pose(1)
    wait_for(lambda: app.server.started == [1], what="the pose's goal")
    client.send_goal(3)
    wait_for(lambda: 3 in client.handles, what="a goal that waits to be accepted")
    app.two.publish_pose(2)
    wait_for(lambda: app.guard.held("flow2") == 1, what="the second pose to wait")
    assert app.server.started == [1]
    for order in (1, 2, 3):
        app.server.finish(order)
    wait_for(lambda: len(app.server.ended) == 3, what="the end of all")
    assert app.server.started == [1, 2, 3]
