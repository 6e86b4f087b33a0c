"""What becomes of a command's last message when no more come, in both languages."""

import pytest
import ros1_runs
import ros2_runs

from rtron.sources.code import last_message
from rtron.sources.code.program_runner import run_cpp
from rtron.sources.code.workspace_sources import WorkspaceSources
from rtron.sources.declaration import NodeSite
from rtron.sources.workspace import Workspace

PYTHON = """import rospy
import time
from geometry_msgs.msg import Twist
from std_msgs.msg import Float32


class Base:
    def __init__(self):
        self.last = time.time()
        self.speed = 0.0
        self.fresh = False
        self.motor = Motor()
        self.limit = rospy.get_param('~limit', 0.5)
        self.out = rospy.Publisher('out', Float32, queue_size=1)
        rospy.Subscriber('cmd_vel', Twist, self.on_twist)
        rospy.Timer(rospy.Duration(0.05), self.tick)

    def on_twist(self, message):
        now = rospy.get_time()
{callback}

    def tick(self, event):
        now = rospy.get_time()
{timer}

    def is_late(self):
        return time.time() - self.last > self.limit

    def drive(self, speed):
        self.motor.write(speed)

    def clock(self):
        return time.monotonic() * 1000

    def pace(self):
        return self.speed / (time.monotonic() - self.last)

    def stop_base(self):
        rospy.logwarn('too late')

    def off(self):
        self.motor.write(0)


rospy.init_node('base')
Base()
rospy.spin()
"""
CPP = """
  void on_twist(const geometry_msgs::msg::Twist & message) {{ {callback} }}
  void tick() {{ {timer} }}
  void send(double speed) {{ port_.write(speed); }}
  rclcpp::Time last_; double speed_ = 0.0; bool fresh_ = false; Port port_; double limit_ = 0.5;
  rclcpp::Publisher<std_msgs::msg::Float32>::SharedPtr out_;
  rclcpp::TimerBase::SharedPtr watchdog_timer_;
"""
CPP_BODY = """
    out_ = create_publisher<std_msgs::msg::Float32>("out", 1);
    auto sub = create_subscription<geometry_msgs::msg::Twist>("cmd_vel", 1,
      [this](const geometry_msgs::msg::Twist & m) { on_twist(m); });
    auto timer = create_wall_timer(50ms, std::bind(&N::tick, this));
"""
CHECKED, NOT, STOPPED = ("checked", None), ("unnoticed", None), ("stopped", 1.0)
CHECKED_AT_1, LATER = ("checked", 1.0), ("stopped", None)
SUM = "self.sum += self.speed\nself.drive(self.speed + self.sum)"
KEEP = "self.speed = message.linear.x"
KEEP_WITH_TIME = f"{KEEP}; self.last = now"
BOTH = f"self.turn = message.angular.z; {KEEP_WITH_TIME}"
DRIVE_BOTH = "self.drive([self.speed, self.turn])"
STILL = "if now - self.last > 1: self.speed = 0\n"
STOP_IN_CALLBACK = f"if now - self.last > 1:\n    self.speed = 0.0\n{KEEP_WITH_TIME}"
TAKEN = "if self.speed:\n    self.drive(self.speed)\n    self.last = now{}"
OLD = "speed = 0.0 if age > 1 else self.cmd.speed\nself.drive(speed)"
LATE = "\nif now - self.last > 2: self.off()"
COUNTED = "if self.ticks != self.seen: self.out.publish(self.speed)"
KEEP_CPP = "speed_ = message.linear.x;"
OUT_CPP = "out_->publish(speed_);"
KEEP_WITH_TIME_CPP = f"{KEEP_CPP} last_ = now();"


def indented(text):
    return "\n".join(f"        {line}" for line in text.splitlines())


def python(callback, timer):
    text = PYTHON.format(callback=indented(callback), timer=indented(timer))
    return ros1_runs.run_text(text).last_messages


def cpp(callback, timer):
    members = CPP.format(callback=callback, timer=timer)
    return ros2_runs.cpp(CPP_BODY, members=members).last_messages


def told(found):
    (last,) = found
    return last.fate.value, last.seconds


@pytest.mark.parametrize(
    ("callback", "timer", "fate", "seconds"),
    [
        (KEEP_WITH_TIME, "if now - self.last > 0.5:\n    self.speed = 0.0", "stopped", 0.5),
        (KEEP_WITH_TIME, "if now - self.last > self.limit:\n    self.off()", "stopped", None),
        (KEEP_WITH_TIME, "if 0.5 < now - self.last:\n    self.motor.stop()", "stopped", 0.5),
        (KEEP_WITH_TIME, "age = now - self.last\nif age > 1:\n    self.drive(0)", "stopped", 1.0),
        (KEEP_WITH_TIME, "if self.is_late():\n    self.out.publish(Float32())", "stopped", None),
        (KEEP_WITH_TIME, "late = now - self.last > 1\nif late: self.off()", "stopped", None),
        (
            KEEP_WITH_TIME,
            "speed = 0\nif now - self.last < 1:\n    speed = self.speed\nself.drive(speed)",
            "stopped",
            1.0,
        ),
        (KEEP_WITH_TIME, "self.drive(self.speed if now - self.last < 1 else 0.0)", "stopped", 1.0),
        (
            f"{KEEP}\nself.last = message.header.stamp",
            "if now - self.last > 1: self.off()",
            "stopped",
            1.0,
        ),
        (KEEP_WITH_TIME, "if now - self.last > 0.5:\n    return", "checked", 0.5),
        (KEEP_WITH_TIME, "if now - self.last > 1: self.online = 0", "checked", 1.0),
        (KEEP_WITH_TIME, "if now - self.last > 1: now = 0\nself.drive(self.speed)", "checked", 1.0),
        (
            KEEP_WITH_TIME,
            "if now - self.last > 1: self.log.warn('late', throttle=0)",
            "checked",
            1.0,
        ),
        (
            KEEP_WITH_TIME,
            "on = 1\nif now - self.last > 1: on = 0\nself.log.info(on)",
            "checked",
            1.0,
        ),
        (
            KEEP_WITH_TIME,
            "power = self.limit\nif now - self.last > 1: power = 0\nself.drive(power)",
            "stopped",
            1.0,
        ),
        (f"{KEEP}\nself.fresh = True", "if not self.fresh: pass\nself.fresh = False", *CHECKED),
        (f"{KEEP}\nself.watchdog.reset()", "pass", "checked", None),
        (f"{KEEP}\nself.t = threading.Timer(0.5, self.off)", "pass", "checked", None),
        (KEEP, "self.out.publish(self.speed)", "repeated", None),
        (KEEP_WITH_TIME, "self.out.publish(self.speed)", "repeated", None),
        (KEEP, "speed = 0.0\nspeed = self.speed\nself.out.publish(speed)", "repeated", None),
        (KEEP, "self.out.publish(self.speed)\nself.speed = None", "checked", None),
        (KEEP, "self.out.publish(self.speed)\nself.speed = self.limit", "checked", None),
        (f"{KEEP}\nself.ticks = 0", f"self.ticks += 1\n{COUNTED}", "checked", None),
        (f"{KEEP}\nself.ticks = self.limit", f"self.ticks -= 1\n{COUNTED}", "checked", None),
        (f"{KEEP}\nself.ticks += 1", f"{COUNTED}\nself.seen = self.ticks", "checked", None),
        (f"{KEEP}\nself.ticks += 1", "self.out.publish(self.speed)", "repeated", None),
        (KEEP, "self.speed.stamp = now\nself.out.publish(self.speed)", "repeated", None),
        (KEEP, "self.drive(self.speed)\nself.speed = None", "checked", None),
        (KEEP, "speed, self.speed = self.speed, None\nself.drive(speed)", "checked", None),
        (KEEP, "self.speed = 0.0", "unnoticed", None),
        (f"{KEEP}\nself.ticks = 0", "self.ticks += 1\nif self.ticks > 9: self.off()", *CHECKED),
        ("self.box.put(message)", "self.drive(self.box.get(timeout=1))", "checked", None),
        ("self.box.put(message)", "self.drive(self.box.get_nowait())", "checked", None),
        ("self.box.put(message)", "self.drive(self.box.get(True, 0.5))", *CHECKED),
        ("self.box.put(message)", "self.drive(self.box.get('speed', 0.5))", *NOT),
        ("self.box.put(message)", "self.drive(self.box.get())", "unnoticed", None),
        (f"{KEEP}\nself.last = default_timer()", LATE, "stopped", 2.0),
        (f"{KEEP}\nself.dog.reset()", "self.dog = rospy.Timer(self.limit, self.off)", *CHECKED),
        (f"{KEEP}\nself.dog.reset()", "self.drive(self.speed)", *NOT),
        (f"{KEEP}\nself.came.set()", "if not self.came.wait(0.5): self.off()", "checked", None),
        (KEEP, "self.other.wait(0.5)\nself.drive(self.speed)", "unnoticed", None),
        (f"{KEEP}\nself.loop.call_later(0.5, self.off)", "pass", "checked", None),
        (f"{KEEP}\nself.state['at'] = now", "self.drive(self.speed)", "checked", None),
        (f"{KEEP}\nself.dog.fed = now", "self.drive(self.speed)", "checked", None),
        (f"{KEEP}\nself.state.update(at=now)", "self.drive(self.speed)", "checked", None),
        ("self.pair = (message.linear.x, now)", "self.drive(self.pair[0])", "checked", None),
        (f"global seen\nseen = now\n{KEEP}", "self.drive(self.speed)", "checked", None),
        (f"message.header.stamp = now\n{KEEP}", "self.drive(self.speed)", "unnoticed", None),
        (KEEP_WITH_TIME, "if self.last is None:\n    self.off()", "unnoticed", None),
        (STOP_IN_CALLBACK, "self.drive(self.speed)", "unnoticed", None),
        (KEEP, "if now - self.last > 0.5:\n    self.off()", "unnoticed", None),
        (KEEP, "self.drive(self.speed)", "unnoticed", None),
        (f"{KEEP}\nself.fresh = True", "if self.fresh: self.drive(1)", "unnoticed", None),
        ("self.motor.power = 1", "if not self.motor: self.motor = None", "unnoticed", None),
        (KEEP, TAKEN.format("\n    self.speed = None") + LATE, "stopped", 2.0),
        (KEEP, TAKEN.format("") + LATE, "unnoticed", None),
        (
            "self.speeds[0] = message.linear.x",
            "left, right = self.speeds\nself.speeds = (right, right)\nself.out.publish(right)",
            "repeated",
            None,
        ),
        ("self.drive(message.linear.x)", "pass", "unnoticed", None),
        (
            "self.port = open(self.path)\nself.drive(message.linear.x)",
            "self.out.publish(self.port.read())\nself.port = None",
            "unnoticed",
            None,
        ),
        ("self.out.publish(message.linear.x)", "self.out.publish(1.0)", "unnoticed", None),
        (KEEP, "if self.speed is self.prev: self.drive(b'0')\nself.prev = self.speed", *CHECKED),
        (KEEP, "if self.speed != self.prev: self.drive(self.speed)\nself.prev = self.speed", *NOT),
        (KEEP, "if self.speed == self.limit: self.off()\nself.drive(self.speed)", *NOT),
        (f"{KEEP}\nself.ticks = 5", f"self.ticks = max(0, self.ticks - 1)\n{COUNTED}", *CHECKED),
        (KEEP, "if self.count_publishers('cmd_vel') == 0: self.off()", *CHECKED),
        ("self.box.append(message)", "box, self.box = self.box, []\nself.drive(box)", *CHECKED),
        ("self.box.append(message)", "self.drive(self.box[-1])", *NOT),
        ("self.box.append(message)", "self.out.publish(self.box[-1])", "repeated", None),
        ("self.box.__setitem__('a', (now, message))", "self.drive(self.box['a'])", *CHECKED),
        ("self.drive(message)\ntime.sleep(1)\nself.port.write(b'0')", "pass", *CHECKED),
        ("self.drive(message)\ntime.sleep(1)\nself.pin.output(4, LOW)", "pass", *CHECKED),
        ("self.off()\ntime.sleep(1)\nself.drive(message)", "pass", *NOT),
        ("self.drive(message)\ntime.sleep(1)\nself.port.write(b'x')", "pass", *NOT),
        (
            f"{KEEP}\nself.last = self.clock()",
            "if self.clock() - self.last > 1: self.off()",
            *STOPPED,
        ),
        (f"{KEEP}\nself.last = self.pace()", "if self.pace() - self.last > 1: self.off()", *NOT),
        (KEEP_WITH_TIME, f"{SUM}\nif now - self.last > 1: self.sum = 0", *CHECKED_AT_1),
        (KEEP_WITH_TIME, "if now - self.last > 1: self.led.write(0)", *CHECKED_AT_1),
        (KEEP_WITH_TIME, "if now - self.last > 1: self.old.pop(0)", *CHECKED_AT_1),
        (BOTH, f"if now - self.last > 1: self.turn = 0\n{DRIVE_BOTH}", *CHECKED_AT_1),
        (BOTH, f"if now - self.last > 1: self.turn = self.speed = 0\n{DRIVE_BOTH}", *STOPPED),
        (BOTH, "if now - self.last > 1: self.turn = 0\nself.drive(self.turn)", *STOPPED),
        (BOTH.replace("turn", "angle"), f"{STILL}{DRIVE_BOTH.replace('turn', 'angle')}", *STOPPED),
        (KEEP_WITH_TIME, "if now - self.last > 1: self.stop_base()", *CHECKED_AT_1),
        (f"{KEEP}\nself.seen = self.ticks", f"self.ticks += 1\n{COUNTED}", *CHECKED),
        (f"{KEEP}\nself.seen = self.ticks", "self.ticks += 1\nself.drive(self.speed)", *NOT),
        ("self.cmd = message", f"age = now - self.cmd.stamp\n{OLD}", *CHECKED),
        ("self.cmd = message", f"age = now - self.scan.stamp\n{OLD}", *NOT),
        ("self.cmd = message", f"age = self.limit - self.cmd.speed\n{OLD}", *NOT),
        (
            KEEP_WITH_TIME,
            "if now - self.last > 1: self.port.seek(0)\nself.port.seek(self.limit)",
            *CHECKED_AT_1,
        ),
        (KEEP_WITH_TIME, "if now - self.last > 1: self.pace(self.limit, 0)", *CHECKED_AT_1),
        (
            KEEP_WITH_TIME,
            "self.want = self.speed\nself.go_on(self.want)\nif now - self.last > 1: self.go_on(0)",
            *STOPPED,
        ),
        (KEEP_WITH_TIME, "if now - self.last > 1: self.last = rospy.Time(0)", *CHECKED_AT_1),
        (KEEP_WITH_TIME, "if now - self.last > 1: self.out.publish(Float32(0))", *STOPPED),
        (KEEP_WITH_TIME, "if now - self.last > 1: self.motor.write(left=0)", *STOPPED),
        (KEEP_WITH_TIME, "if now - self.last > 1: self.show_idle_light()", "checked", 1.0),
        (KEEP_WITH_TIME, "if now - self.last > 1: self.sendStopCommand()", *STOPPED),
    ],
)
def test_in_python(callback, timer, fate, seconds):
    assert told(python(callback, timer)) == (fate, seconds)


@pytest.mark.parametrize(
    ("callback", "timer", "fate", "seconds"),
    [
        (KEEP_WITH_TIME_CPP, "if ((now() - last_).seconds() > 0.5) speed_ = 0.0;", "stopped", 0.5),
        (
            KEEP_WITH_TIME_CPP,
            "if (now() - last_ > rclcpp::Duration::from_seconds(1.5)) send(0);",
            "stopped",
            1.5,
        ),
        (
            KEEP_WITH_TIME_CPP,
            "auto age = now() - last_;\nif (age.seconds() > limit_) { port_.stop(); }",
            "stopped",
            None,
        ),
        (
            KEEP_WITH_TIME_CPP,
            "out_->publish((now() - last_).seconds() > limit_ ? 0.0 : speed_);",
            "stopped",
            None,
        ),
        (KEEP_WITH_TIME_CPP, "if ((now() - last_).seconds() > 0.5) return;", "checked", 0.5),
        (KEEP_WITH_TIME_CPP, "if (now() - last_ > 1.0) tcflush(fd_, 0);", *CHECKED_AT_1),
        (
            f"turn_ = message.angular.z; {KEEP_WITH_TIME_CPP}",
            "if (now() - last_ > 1.0) { turn_ = 0; } double both[2] = {speed_, turn_}; send(both);",
            *CHECKED_AT_1,
        ),
        (f"{KEEP_CPP} watchdog_timer_->reset();", "", "checked", None),
        (f"{KEEP_CPP} fresh_ = true;", "if (!fresh_) return; fresh_ = false;", "checked", None),
        (KEEP_CPP, "out_->publish(speed_);", "repeated", None),
        (KEEP_CPP, "double s = 0; s = speed_; out_->publish(s);", "repeated", None),
        (KEEP_CPP, "out_->publish(speed_); speed_ = 0;", "checked", None),
        (KEEP_CPP, "out_->publish(std::move(speed_));", "checked", None),
        (f"{KEEP_CPP} ticks_ = 0;", "if (++ticks_ < 9) out_->publish(speed_);", *CHECKED),
        (f"if (now() - last_ > limit_) send(0); {KEEP_WITH_TIME_CPP}", "", "unnoticed", None),
        (KEEP_CPP, "double speed = 0; send(speed_);", "unnoticed", None),
        (KEEP_CPP, "auto speed = std::exchange(speed_, 0); send(speed);", "checked", None),
        (f"{KEEP_CPP} cv_.notify_one();", "cv_.wait_for(lock, 500ms); send(speed_);", *CHECKED),
        (f"{KEEP_CPP} timer_.expires_after(500ms);", "send(speed_);", "checked", None),
        (KEEP_CPP, "options.event_callbacks.deadline_callback = off; send(speed_);", *CHECKED),
        (KEEP_CPP, "if ((now() - last_).seconds() > 0.5) speed_ = 0.0;", "unnoticed", None),
        ("auto last = now(); send(message.linear.x);", "", "unnoticed", None),
    ],
)
def test_in_cpp(callback, timer, fate, seconds):
    assert told(cpp(callback, timer)) == (fate, seconds)


def test_what_a_constructor_sets_is_not_set_back():
    members = CPP.format(callback=f"{KEEP_CPP} fresh_ = true;", timer="if (fresh_) send(speed_);")
    found = ros2_runs.cpp(f"fresh_ = false;{CPP_BODY}", members=members)
    assert told(found.last_messages) == ("unnoticed", None)


UPDATE = """    def update(self):
        if time.time() - self.last > 2:
            self.off()

    def is_late"""


@pytest.mark.parametrize(
    ("callback", "timer", "fate"),
    [
        ("self.update()", "pass", "unnoticed"),
        ("self.update()", "self.update()", "stopped"),
        ("pass", "self.update()", "stopped"),
        ("pass", "pass", "checked"),
    ],
)
def test_a_test_that_the_message_itself_runs_stops_nothing(callback, timer, fate):
    text = PYTHON.format(
        callback=indented(f"{KEEP_WITH_TIME}\n{callback}"), timer=indented(timer)
    ).replace("    def is_late", UPDATE)
    assert told(ros1_runs.run_text(text).last_messages)[0] == fate


@pytest.mark.parametrize(
    ("base", "fate"), [("acme.Driver", "checked"), ("Thread", "unnoticed"), ("object", "unnoticed")]
)
def test_a_base_that_is_not_read_may_look_at_the_age(base, fate):
    text = PYTHON.format(callback=indented(KEEP), timer=indented("self.drive(self.speed)"))
    head = "import acme\nfrom threading import Thread\n"
    text = head + text.replace("class Base:", f"class Base({base}):")
    assert told(ros1_runs.run_text(text).last_messages)[0] == fate


MODULE = """import rospy
from geometry_msgs.msg import Twist
from Queue import Queue

box = Queue()
speed = seen = count = 0


def on_twist(message):
    global speed, seen, count
    {callback}


rospy.init_node('base')
rospy.Subscriber('cmd_vel', Twist, on_twist)
while not rospy.is_shutdown():
{loop}
"""


@pytest.mark.parametrize(
    ("callback", "loop", "fate"),
    [
        ("box.put(message)", "    port.write(box.get(True, 0.5))", "checked"),
        ("box.put(message)", "    port.write(box.get())", "unnoticed"),
        (
            "speed = message.linear.x; seen = rospy.get_time()",
            "    if rospy.get_time() - seen > 1:\n        speed = 0\n    port.write(speed)",
            "stopped",
        ),
        (
            "speed = message.linear.x; count = 0",
            "    count += 1\n    if count > 9:\n        speed = 0\n    port.write(speed)",
            "checked",
        ),
        ("speed = message.linear.x", "    port.write(speed)", "unnoticed"),
    ],
)
def test_a_loop_of_the_top_level_looks_at_the_age(callback, loop, fate):
    text = MODULE.format(callback=callback, loop=loop)
    assert told(ros1_runs.run_text(text).last_messages)[0] == fate


@pytest.mark.parametrize(
    ("beside", "fates"),
    [
        ("self.create_timer(1, self.check)", ["stopped"]),
        ("rospy.Timer(rospy.Duration(1), self.tick)", ["checked"]),
        ("rospy.Subscriber('other', Twist, self.drive)", ["checked", "checked"]),
    ],
)
def test_what_stands_on_one_line(beside, fates):
    subscription = "rospy.Subscriber('cmd_vel', Twist, self.on_twist)"
    late = indented("if self.is_late(): self.off()")
    text = PYTHON.format(callback=indented(KEEP_WITH_TIME), timer="        pass")
    text = text.replace("    def is_late", f"    def check(self):\n{late}\n\n    def is_late")
    text = text.replace(subscription, f"{subscription}; {beside}")
    assert [each.fate.value for each in ros1_runs.run_text(text).last_messages] == fates


@pytest.mark.parametrize(("call", "fate"), [("self.update()", "stopped"), ("pass", "checked")])
def test_a_loop_that_looks_at_the_age_stops(call, fate):
    text = PYTHON.format(callback=indented(KEEP_WITH_TIME), timer=indented("pass"))
    head = "    def run(self):\n        while not rospy.is_shutdown():\n            "
    loop = f"{head}{call}\n\n{UPDATE}"
    text = text.replace("    def is_late", loop).replace("Base()\n", "Base().run()\n")
    assert told(ros1_runs.run_text(text).last_messages)[0] == fate


HELPERS = """    def report(self, value):
        self.out.publish(value)

    def kept(self):
        return self.speed

    def unused(self):
        self.out.publish(self.speed)

    def beat(self, event):
        self.out.publish(1.0)

    def is_late"""


@pytest.mark.parametrize(
    ("timer", "fate"),
    [
        ("self.drive(self.speed)", "unnoticed"),
        ("self.report(self.speed)", "repeated"),
        ("self.report(self.limit)", "unnoticed"),
        ("self.out.publish(self.kept())", "repeated"),
        ("if self.speed > 1: self.report(1.0)", "repeated"),
        ("if self.speed > 1: self.drive(self.limit)\nself.report(self.limit)", "unnoticed"),
    ],
)
def test_what_publishes_something_else_repeats_nothing(timer, fate):
    text = PYTHON.format(callback=indented(KEEP), timer=indented(timer))
    second = "self.tick)\n        rospy.Timer(rospy.Duration(1), self.beat)"
    text = text.replace("    def is_late", HELPERS).replace("self.tick)", second)
    assert told(ros1_runs.run_text(text).last_messages)[0] == fate


def test_where_it_is():
    (last,) = python(KEEP_WITH_TIME, "if now - self.last > 0.5:\n    self.off()")
    lines = PYTHON.format(callback="\n", timer="HERE").splitlines()
    made = next(at for at, line in enumerate(lines, 1) if "Subscriber(" in line)
    assert [place.line for place in last.evidence] == [made, lines.index("HERE")]


@pytest.mark.parametrize(
    ("timer", "names"),
    [
        ("self.out.publish(self.speed)", ["out"]),
        ("self.out.publish(self.limit); self.shown.publish(self.speed)", ["shown"]),
        ("v = Float32()\nv.data = self.speed\nself.shown.publish(v)", ["shown"]),
        ("v = []\nv.append(self.speed)\nself.shown.publish(v)", ["shown"]),
        ("v, w = self.speed, 1\nself.shown.publish(w)\nself.out.publish(3)", ["shown"]),
        ("v = 0\nif self.speed > 1: v = 1\nself.shown.publish(v)", ["shown"]),
        ("self.shown.publish(self.speed); self.out.publish(self.speed)", ["out", "shown"]),
        ("make().publish(self.speed); self.out.publish(1)", []),
    ],
)
def test_where_the_publisher_is_made_that_repeats_it(timer, names):
    text = PYTHON.format(callback=indented(KEEP), timer=indented(timer))
    second = "rospy.Publisher('shown', Float32)\n        rospy.Timer"
    text = text.replace("rospy.Timer", f"self.shown = {second}", 1)
    found = ros1_runs.run_text(text)
    made = {at: each.name for each in found.declarations for at in each.evidence}
    (last,) = found.last_messages
    assert last.fate.value == "repeated"
    assert sorted(made[at].rpartition("/")[2] for at in last.evidence[1:]) == names


@pytest.mark.parametrize(
    ("topic", "type", "fate"),
    [
        ("joint_states", "JointState", "unnoticed"),
        ("target_angles", "JointState", "repeated"),
        ("joint_states", "Joy", "repeated"),
    ],
)
def test_what_tells_how_something_stands_repeats_no_command(topic, type, fate):
    text = PYTHON.format(callback=indented(KEEP), timer=indented("self.out.publish(self.speed)"))
    text = text.replace("std_msgs.msg import Float32", f"sensor_msgs.msg import {type} as Float32")
    assert told(ros1_runs.run_text(text.replace("'out'", f"'{topic}'")).last_messages)[0] == fate


def test_where_the_publisher_is_made_in_cpp():
    found = ros2_runs.cpp(CPP_BODY, members=CPP.format(callback=KEEP_CPP, timer=OUT_CPP))
    (out,) = (each for each in found.declarations if each.name.endswith("/out"))
    assert found.last_messages[0].evidence[1:] == out.evidence


def test_what_is_measured_is_no_command():
    text = PYTHON.format(callback=indented(KEEP), timer=indented("pass"))
    measured = text.replace("geometry_msgs.msg import Twist", "sensor_msgs.msg import Imu as Twist")
    assert ros1_runs.run_text(measured).last_messages == ()


LIBRARY = "".join(f"int f{n}() {{ return {n}; }}\n" for n in range(9))
RELAY = """#include "library.hpp"
geometry_msgs::Twist kept;
ros::Publisher out;
void on_twist(const geometry_msgs::Twist::ConstPtr& message) { kept = *message; }
int main(int argc, char **argv) {
  ros::init(argc, argv, "n");
  ros::NodeHandle nh;
  out = nh.advertise<geometry_msgs::Twist>("out", 1);
  ros::Subscriber in = nh.subscribe("in", 1, on_twist);
  while (ros::ok()) { out.publish(kept); ros::spinOnce(); }
}
"""


def test_a_library_in_headers_hides_no_function_of_the_program(tmp_path, monkeypatch):
    monkeypatch.setattr(last_message, "_MAX_FUNCTIONS", 3)
    (tmp_path / "library.hpp").write_text(LIBRARY)
    (tmp_path / "n.cpp").write_text(RELAY)
    files = WorkspaceSources(Workspace({"p": tmp_path}, [tmp_path]))
    found = run_cpp((tmp_path / "n.cpp",), NodeSite(name="/n"), files)
    assert told(found.last_messages) == ("repeated", None)
