"""A guarded base in memory whose streams are noted, with the machine's own clock."""

import os
import subprocess
from contextlib import contextmanager, suppress
from dataclasses import replace

from app_in_memory import info, made, written
from plans import grcn, plan_of
from streams import TWIST, peer
from velocity_messages import twist

from rtron.guard.coordinator import Coordinator
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.observations import observations_of
from rtron.guard.incidents.recorder_link import RecorderLink
from rtron.guard.supervision.guard_config import GuardConfig
from rtron.guard.supervision.helper_process import HelperProcess
from rtron.guard.supervision.programs import INCIDENTS, start_program
from rtron.guard.system.process_port import ProcessPort
from rtron.guard.transport.common.memory import MemoryTransport
from rtron.guard.transport.common.protocol import Peer
from rtron.vocabulary import (
    MSRCN,
    RSRCN,
    SECOND,
    Area,
    EventFlow,
    Flow,
    GuardedTopic,
    IncidentRecording,
    MissionRule,
    Mode,
    Point,
    PolicyName,
    build_streams,
)

TOPIC, FAST, ALLOWED = "/cmd_vel", 1.0, 0.25
STEP = SECOND // 20
LIMIT_S = 20.0


def speed_plan(app="drive", limit=ALLOWED, **incidents):
    """Return a plan with one publisher, /teleop, that may drive at 0.25 m/s."""
    flow = Flow(name="flow1", publisher="/teleop")
    topic = GuardedTopic(topic=TOPIC, type=TWIST.type, flows=(flow,), successors=("/base",))
    limits = RSRCN(
        id="rsrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.CONSTRAIN,
        max_vel_limit=limit,
        vflows=(topic,),
    )
    recording = IncidentRecording(**{"after": SECOND // 2, "megabytes": 16} | incidents)
    node = grcn(TOPIC, ("/teleop",), ("/base",))
    return plan_of(node, app=app, rsrcn=limits, incidents=recording)


CORNERS = ((3.0, -1.0), (5.0, -1.0), (5.0, 1.0), (3.0, 1.0))
KITCHEN = Area(name="kitchen", frame="map", polygon=tuple(Point(x=x, y=y) for x, y in CORNERS))


def posed_plan(**incidents):
    """Return the plan of a drive whose rules know where the robot is, and an area."""
    here = EventFlow(
        name="in_kitchen",
        topic="/pose",
        publisher="/amcl",
        type="geometry_msgs/PoseStamped",
        when="inside(event.pose.position, kitchen)",
    )
    plan = speed_plan(**incidents)
    moving = plan.rsrcn.vflows[0]
    rule = MissionRule(name="keep_out", when="in_kitchen", block=(TOPIC,))
    msrcn = MSRCN(
        id="msrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.BLOCK,
        aflows=(moving,),
        eflows=(here,),
        rules=(rule,),
        areas=(KITCHEN,),
    )
    return replace(plan, msrcn=msrcn)


class Drive:
    """A base that /teleop drives through a guard in memory."""

    def __init__(self, plan, now):
        self.transport = MemoryTransport()
        self.transport.jump(now)
        self.host = Coordinator(self.transport, build_streams(plan), observations_of(plan))
        self.host.open()
        self.driven = self.transport.listen("/rtron/cmd_vel/out")
        self._publish = self._say_pose = None

    def command(self, x):
        """Let /teleop say how fast to drive."""
        if self._publish is None:
            self._publish = self.transport.publisher("/rtron/cmd_vel/flow1", peer("/teleop"))
        self._publish(twist(x=x))

    def be_slow(self):
        """Let /teleop drive as slowly as it may."""
        self.command(0.1)

    def be_at(self, x):
        """Let /amcl say where the robot is, heading along x."""
        type = "geometry_msgs/PoseStamped"
        if self._say_pose is None:
            self._say_pose = self.transport.publisher("/pose", Peer("/amcl", info(type)))
        seconds, nanoseconds = divmod(self.transport.now(), SECOND)
        message = made(type)
        message.header.frame_id = "map"
        message.header.stamp.sec, message.header.stamp.nanosec = seconds, nanoseconds
        message.pose.position.x, message.pose.orientation.w = x, 1.0
        self._say_pose(written(type, message))

    def catch_up(self, now):
        """Let the guard's clock go on to `now` (ns)."""
        self.transport.advance(max(0, now - self.transport.now()))


class _Started:
    """A process as `ForkedProcess` is one: a test has several threads, and cannot fork."""

    def __init__(self, program, files):
        self._process = start_program(program, files)
        self.pid, self.poll = self._process.pid, self._process.poll
        self.send_signal = self._process.send_signal

    def wait(self, timeout):
        with suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout)


class _Starter:
    """In the fork server's place."""

    start = staticmethod(_Started)


@contextmanager
def recorded_drive(folder, plan=None):
    """Yield a drive and the loop of its recorder, which is a process of its own."""
    plan, loop, port = plan or speed_plan(), EventLoop(), ProcessPort()
    drive = Drive(plan, loop.now())
    config = GuardConfig(plan=plan, master="").write_to_memory()
    drive.recorder = HelperProcess(
        _Starter,
        config,
        INCIDENTS,
        files=[port.accepting_side.fileno()],
        is_needed=port.has_connection,
    )
    link = RecorderLink(plan, folder, port.connecting_side, drive.host, loop)
    drive.link, drive.loop = link, loop
    link.open()
    try:
        yield drive
    finally:
        link.close()
        loop.close()
        drive.recorder.stop(20)
        port.connecting_side.close()
        port.accepting_side.close()
        os.close(config)
        assert drive.recorder.process.poll() == 0, "it ends when the bulk process has"


def run_until(drive, condition, limit_s=LIMIT_S, every_step=lambda: None):
    """Serve the loop until a condition holds; the guard's clock follows the machine's."""
    end = drive.loop.now() + int(limit_s * SECOND)
    while not condition():
        assert drive.loop.now() < end, f"not within {limit_s:g} s"
        drive.catch_up(drive.loop.now())
        drive.recorder.tick(drive.loop.now())
        every_step()
        drive.loop.step(STEP / SECOND)
