"""Plans with a speed limit for a robot of either ROS, and what its base may hear under them."""

import signal
from itertools import pairwise
from statistics import median

from harness import wait_for

from rtron.policies.velocity_limit.speed_limits import DEFAULT_RISE
from rtron.vocabulary import (
    RSRCN,
    SECOND,
    Flow,
    FpsMonitor,
    GuardedTopic,
    Mode,
    Plan,
    PolicyName,
    Supervision,
    flow_topic,
    output_topic,
)

TOPIC = "/cmd_vel"
NAV, OUT = flow_topic(TOPIC, "nav"), output_topic(TOPIC)
THRESHOLD, SPEED = 0.04, 0.4
CRAWL = THRESHOLD * 5
"""A limit under which the robot is only when frames are later than a camera of 30 a second is."""
SLOWEST = THRESHOLD * 2.5
"""What two frames a second allow, and a little more."""
FRAMES = 4
STRAIGHT, TURN = 0.25, 1.0
"""What a navigation asks for that turns, in m/s and rad/s."""
LONGEST_STEP_S = 0.1
"""A command raises the speed by no more than it may rise in this time."""
ROUNDING = 1e-9


def limited(ros, type, **limits):
    """Return a plan that limits what /nav asks of /robot, which also has the camera."""
    moving = GuardedTopic(
        topic=TOPIC,
        type=type,
        flows=(Flow(name="nav", publisher="/nav", silent_after=3 * SECOND),),
        successors=("/robot",),
    )
    rsrcn = RSRCN(id="rsrcn", mode=Mode.ENFORCE, vflows=(moving,), **limits)
    camera = FpsMonitor(id="fps_camera", node="/robot", topic="/image")
    monitors = (camera,) if rsrcn.policy is PolicyName.SAFE else ()
    return Plan(
        app="robot",
        ros=ros,
        revision=1,
        rsrcn=rsrcn,
        fps_monitor=monitors,
        supervision=Supervision(stall_after=SECOND // 5),
    )


class FilmingRobot:
    """What `camera_base` says: its frames, when its camera gets slow or fast, and its speeds."""

    def __init__(self, process):
        self._process = process

    def lines(self, since=0):
        """Return what it has said, line by line."""
        return self._process.log.split("\n")[since:-1]

    def switch(self, word):
        """Let the camera get slow or fast; return where in the lines that begins."""
        before = len(self.lines())
        self._process.tell(signal.SIGUSR1)
        wait_for(lambda: word in self.lines(before), what=f"{word} frames")
        return before + self.lines(before).index(word)

    def wait_for_full_speed(self, since):
        wait_for(lambda: SPEED in speeds(self.lines(since)), what="full speed")


def commands(lines):
    """Return what the base was told: the speed (m/s) and when (s of its steady clock), each."""
    told = (line.split()[1:] for line in lines if line.startswith("speed "))
    return [(float(speed), float(at)) for speed, at in told]


def speeds(lines):
    return [speed for speed, _ in commands(lines)]


def largest_step(told):
    """Return by how much (m/s) a command is faster than the limit can have risen since the last.

    Messages take their time: where a guard was late, two may come together.
    """
    pairs = pairwise(told)
    return max(after - before - DEFAULT_RISE * (at - then) for (before, then), (after, at) in pairs)


def assert_the_limit_falls_at_once_and_rises_slowly(robot):
    """Let the camera of a robot at full speed fall from 30 to 2 frames a second, and rise again."""
    robot.wait_for_full_speed(0)
    slow = robot.switch("slow")
    wait_for(lambda: robot.lines(slow).count("frame") >= FRAMES, what="late frames")
    fast = robot.switch("fast")
    robot.wait_for_full_speed(fast)
    lines = robot.lines()
    late = lines.index("frame", slow)
    second = lines.index("frame", late + 1)
    assert speeds(lines[slow:late])[-1] <= CRAWL, "before the first late frame"
    assert median(speeds(lines[late:second])) <= SLOWEST, "the first late frame lifts the limit"
    assert max(speeds(lines[late:fast])) <= CRAWL, "between late frames"
    assert largest_step(commands(lines[fast:])) <= CRAWL / 2


def assert_turns_at_most(velocities, most):
    """Assert that a robot which is told to turn faster keeps on its curve: (m/s, rad/s) each."""
    assert (STRAIGHT * most / TURN, most) in velocities
    assert max(turn for _, turn in velocities) == most


def assert_speeds_up_by(velocities, accel):
    """Assert that no command is faster than the one before by more than `accel` (m/s2) allows."""
    found = [0.0, *(speed for speed, _ in velocities)]
    rises = [after - before for before, after in pairwise(found)]
    assert max(found) == STRAIGHT
    assert max(rises) <= accel * LONGEST_STEP_S + ROUNDING
