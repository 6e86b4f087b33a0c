"""The demo as its runner launches it, for the tests on both ROS."""

import json
import time
from collections import Counter, defaultdict

from harness import wait_for

from rtron.demos.metrics.guard_events import decision_counts
from rtron.demos.runtime.app_launch import launch_app
from rtron.demos.world.scenes.generator import make_scene

SPEED = 3.0
# A navigation that a busy machine holds up keeps the output: only the policy is tested here.
MOVE_BASE = {"/move_base": {"priority": 9}}
CMD_VEL = {"policy": "Preemption", "flows": MOVE_BASE, "release_after": "5 s"}
DECISIONS = {"grcn": {"/cmd_vel": CMD_VEL}}
LIMIT_T = 60.0


def drive(begun, case, seed=3, *, attack=False):
    """Drive a mission of a case; return its last Truth, at the goal or under harm."""
    reset, scene = begun.owner.reset(case, seed), make_scene(case, seed)
    begun.write_map(scene)
    begun.arm_attack(case if attack else "none", reset.run, 3.0, scene.bad_goal)
    while not any(truth.t > reset.t + 1 for truth in begun.owner.poll(5.0)):
        pass  # the nodes are to know where the robot is now
    since = begun.owner.start()
    while True:
        for truth in begun.owner.poll(5.0):
            late = truth.t - since > LIMIT_T
            if truth.distance_to_goal < 0.17 or truth.collided or truth.in_area or late:
                begun.arm_attack("none", reset.run)
                return truth


def malicious_entries(begun, node, what="sent"):
    """Return what a node has noted of malicious turns."""
    path = begun.journal / f"{node}.jsonl"
    lines = map(json.loads, path.read_text().splitlines() if path.exists() else [])
    return [line for line in lines if line["what"] == what and line["value"] == [0.0, -0.2]]


def guarded_run(begun, pipeline, service):
    """Guard the app and attack it twice over; return the last Truth and what the guard counted."""
    guarded_launch = pipeline.instrument(DECISIONS)
    with (
        launch_app(begun, guarded_launch, service.environ(), pipeline.plan) as app,
        begun.run_manual_attacker(),
    ):
        service.wait_until_linked(time.time_ns())
        since = time.time_ns()
        truth = drive(begun, "gr", attack=True)
        app.check()
        return truth, sums_by_flow(service.events(since, time.time_ns()), "/cmd_vel")


def check_guarded(begun, truth, counts):
    """Check that the robot is at its goal, and that no malicious command has reached it."""
    assert truth.distance_to_goal < 0.17
    assert not truth.collided
    for node in ("tb3_safe_control", "safe_control_by_hand"):
        assert len(malicious_entries(begun, node)) > 50
    assert malicious_entries(begun, "turtlebot3_core", "received") == []
    assert counts["flow2"]["drop"] > 50
    assert counts["unapproved"]["drop"] > 50
    assert counts["flow1"]["pass"] > 100


def sums_by_flow(events, topic):
    """Return by flow of a topic how many messages met which decision."""
    found = defaultdict(Counter)
    for each in decision_counts(events):
        if each.topic == topic:
            found[each.flow].update(each.counts)
    return found


def wait_until_gone(paths):
    """Wait until files are there no more."""
    wait_for(lambda: not any(path.exists() for path in paths), what=f"an end of {paths}")
