"""What becomes of a command's last message when no more come, in both languages.

silent_drivers.txt has a driver a line: what becomes of it in truth (it `stops`, after so many
seconds where a limit says so; the hardware `keeps` the last command; it `repeats` that on a topic;
no source tells: `unclear`), the body of the callback, that of the timer, and of Python how that is
started, the type of the message and the base class.
"""

from pathlib import Path

import pytest
import ros1_runs
import ros2_runs

FATES = {"stopped": "stops", "unnoticed": "keeps", "repeated": "repeats", "checked": "unclear"}
PYTHON = """import queue
import random
import threading
import time
from collections import deque
import acme
import rospy
from ackermann_msgs.msg import AckermannDrive
from geometry_msgs.msg import Twist
from sensor_msgs.msg import Imu
from std_msgs.msg import Bool, Float32, String
from Queue import Queue


class Base({base}):
    def __init__(self):
        self.last = 0
        self.speed = self.turn = self.ticks = self.seen = 0
        self.cmd = self.previous = None
        self.fresh = self.enabled = False
        self.items, self.state, self.recent = [], {{}}, deque(maxlen=5)
        self.box, self.came, self.lock = Queue(), threading.Event(), threading.Lock()
        self.motor, self.led, self.pin = acme.Motor(), acme.Led(), 4
        self.limit = rospy.get_param('~limit', 0.5)
        self.unset = rospy.get_param('~unset')
        self.out = rospy.Publisher('out', Float32, queue_size=1)
        self.moves = rospy.Publisher('moves', Twist, queue_size=1)
        self.rate = rospy.Rate(10)
        rospy.Subscriber('cmd_vel', {type}, self.on_command)
        rospy.Subscriber('imu', Imu, self.on_imu)
        rospy.Service('enable', Bool, self.on_enable)
        rospy.on_shutdown(self.off)
        {start}

    def on_imu(self, message):
        self.tilt = message.orientation.x
        self.seen_imu = time.time()

    def on_enable(self, request):
        self.enabled = request.data

    def on_command(self, message):
{callback}

    def tick(self, event=None):
{timer}

    def is_late(self):
        return time.time() - self.last > self.limit

    def drive(self, speed):
        self.motor.write(speed)

    def mix(self, speed, turn):
        return speed - turn * 0.2, speed + turn * 0.2

    def send(self, speed, turn):
        twist = Twist()
        twist.linear.x = speed
        twist.angular.z = turn
        self.moves.publish(twist)

    def off(self):
        self.motor.write(0)


def main():
    rospy.init_node('base')
    base = Base()
    rospy.spin()


if __name__ == '__main__':
    main()
"""
TIMER = "rospy.Timer(rospy.Duration(0.05), self.tick)"
CPP = """
  void on_command(const geometry_msgs::msg::Twist & message) {{ {callback} }}
  void tick() {{ {timer} }}
  void send(double speed) {{ port_.write(speed); }}
  rclcpp::Time last_; double speed_ = 0.0; double turn_ = 0.0; bool fresh_ = false; Port port_;
  double limit_ = 0.5; int ticks_ = 0; geometry_msgs::msg::Twist command_; int fd_;
  geometry_msgs::msg::Twist::SharedPtr kept_;
  std::chrono::steady_clock::time_point then_;
  rclcpp::Publisher<geometry_msgs::msg::Twist>::SharedPtr out_;
  rclcpp::TimerBase::SharedPtr timer_;
"""
CPP_BODY = """
    limit_ = declare_parameter("limit", 0.25);
    out_ = create_publisher<geometry_msgs::msg::Twist>("out", 1);
    auto sub = create_subscription<geometry_msgs::msg::Twist>("cmd_vel", 1,
      [this](const geometry_msgs::msg::Twist & m) { on_command(m); });
    timer_ = create_wall_timer(50ms, std::bind(&N::tick, this));
"""
DRIVERS = Path(__file__).with_name("silent_drivers.txt").read_text().splitlines()


def indented(text):
    return "\n".join(f"        {line}" for line in text.splitlines())


def python(callback, timer="pass", start="", type="", base=""):
    text = PYTHON.format(
        callback=indented(callback),
        timer=indented(timer),
        start=start or TIMER,
        type=type or "Twist",
        base=base or "object",
    )
    return ros1_runs.run_text(text)


def cpp(callback, timer):
    return ros2_runs.cpp(CPP_BODY, members=CPP.format(callback=callback, timer=timer))


def told(interface):
    (last,) = interface.last_messages
    return FATES[last.fate.value], last.seconds


@pytest.mark.parametrize("line", DRIVERS)
def test_a_driver_in_silence(line):
    kind, *parts = (part.strip().replace("\\n", "\n") for part in line.split(" ~ "))
    language, fate, *seconds = kind.split()
    found = {"python": python, "cpp": cpp}[language](*parts)
    assert told(found) == (fate, float(seconds[0]) if seconds else None)


WHOLE = {
    "a loop of the top level": (
        "stops",
        1.0,
        "py",
        1,
        """
import rospy, time, acme
from geometry_msgs.msg import Twist
speed = seen = 0
def on_command(message):
    global speed, seen
    speed, seen = message.linear.x, rospy.get_time()
rospy.init_node('base')
rospy.Subscriber('cmd_vel', Twist, on_command)
port = acme.Port()
rate = rospy.Rate(10)
while not rospy.is_shutdown():
    if rospy.get_time() - seen > 1:
        speed = 0
    port.write(speed)
    rate.sleep()
port.write(0)
""",
    ),
    "a base class that looks at the age": (
        "stops",
        0.3,
        "py",
        2,
        """
import rclpy, serial
from rclpy.node import Node
from geometry_msgs.msg import Twist
class Driver(Node):
    def __init__(self):
        super().__init__('driver')
        self.declare_parameter('timeout', 0.3)
        self.timeout = self.get_parameter('timeout').value
        self.last = self.get_clock().now()
        self.create_timer(0.05, self.check)
    def check(self):
        age = (self.get_clock().now() - self.last).nanoseconds / 1e9
        if age > self.timeout:
            self.apply(0.0)
    def touch(self):
        self.last = self.get_clock().now()
class Rover(Driver):
    def __init__(self):
        super().__init__()
        self.port = serial.Serial('/dev/ttyUSB0', 115200)
        self.create_subscription(Twist, 'cmd_vel', self.on_command, 10)
    def on_command(self, message):
        self.touch()
        self.apply(message.linear.x)
    def apply(self, speed):
        self.port.write(f'{speed:.2f}\\n'.encode())
def main():
    rclpy.init()
    rclpy.spin(Rover())
    rclpy.shutdown()
""",
    ),
    "a main loop of roscpp": (
        "stops",
        0.5,
        "cpp",
        1,
        """
#include <ros/ros.h>
#include <geometry_msgs/Twist.h>
class Base {
public:
  Base() : nh_("~"), speed_(0), timeout_(0.5) {
    nh_.param("timeout", timeout_, 0.5);
    sub_ = nh_.subscribe("/cmd_vel", 1, &Base::onCommand, this);
    last_ = ros::Time::now();
  }
  void onCommand(const geometry_msgs::Twist::ConstPtr& message) {
    speed_ = message->linear.x;
    last_ = ros::Time::now();
  }
  void run() {
    ros::Rate rate(20);
    while (ros::ok()) {
      ros::spinOnce();
      if ((ros::Time::now() - last_).toSec() > timeout_) speed_ = 0;
      serial_.write(speed_);
      rate.sleep();
    }
  }
private:
  ros::NodeHandle nh_; ros::Subscriber sub_; ros::Time last_; double speed_, timeout_;
  serial::Serial serial_;
};
int main(int argc, char** argv) { ros::init(argc, argv, "base"); Base base; base.run(); }
""",
    ),
}


@pytest.mark.parametrize("name", WHOLE)
def test_a_whole_program_in_silence(name):
    fate, seconds, suffix, ros, text = WHOLE[name]
    found = (ros1_runs if ros == 1 else ros2_runs).run_text(text, suffix)
    assert told(found) == (fate, seconds)


def lines_of(interface):
    (last,) = interface.last_messages
    return [place.line for place in last.evidence]


def line_of(text, callback="pass", timer="pass"):
    lines = PYTHON.format(
        callback=indented(callback), timer=indented(timer), start=TIMER, type="Twist", base="object"
    ).splitlines()
    return next(at for at, line in enumerate(lines, 1) if text in line)


def test_where_a_program_looks_at_the_time():
    callback = "self.drive(message.linear.x)\nself.last = time.time()"
    timer = "if time.time() - self.last > 0.5:\n    self.off()"
    expected = [line_of("'cmd_vel'"), line_of("> 0.5", callback, timer)]
    assert lines_of(python(callback, timer)) == expected


@pytest.mark.parametrize(
    ("timer", "topics"),
    [
        ("self.out.publish(self.speed)", ["out"]),
        ("self.out.publish(3)\nself.send(self.speed, 0)", ["moves"]),
        ("self.send(self.speed, 0)\nself.out.publish(self.speed)", ["out", "moves"]),
        ("acme.make().publish(self.speed)", []),
    ],
)
def test_where_the_publisher_is_made_that_repeats_it(timer, topics):
    found = python("self.speed = message.linear.x", timer)
    assert told(found)[0] == "repeats"
    assert lines_of(found)[1:] == [line_of(f"Publisher('{topic}'") for topic in topics]


@pytest.mark.parametrize(
    ("topic", "type", "fate"),
    [
        ("joint_states", "JointState", "keeps"),
        ("target_angles", "JointState", "repeats"),
        ("joint_states", "Joy", "repeats"),
    ],
)
def test_what_tells_how_something_stands_repeats_no_command(topic, type, fate):
    text = PYTHON.format(
        callback=indented("self.speed = message.linear.x"),
        timer=indented("self.out.publish(self.speed)"),
        start=TIMER,
        type="Twist",
        base="object",
    )
    text = text.replace("import Imu", f"import Imu, {type}").replace(
        "out', Float32", f"out', {type}"
    )
    assert told(ros1_runs.run_text(text.replace("'out'", f"'{topic}'")))[0] == fate


def test_what_is_measured_is_no_command():
    assert python("self.speed = message.linear.x", type="Imu").last_messages == ()


@pytest.mark.parametrize(
    "timer",
    [
        "while True:\n    self.drive(self.speed)",
        "self.tick()\nself.drive(self.speed)",
        "self.items = [self.items] * 4096\nself.out.publish(self.items)",
        "for a in range(999):\n    for b in range(999): self.speed *= 2\nself.drive(self.speed)",
    ],
)
def test_a_program_without_end_is_bounded(timer):
    assert len(python("self.speed = message.linear.x", timer).last_messages) == 1


def test_what_runs_in_silence_leaves_nothing_behind():
    made = "rospy.Publisher('late', Float32).publish(message.linear.x)"
    names = [each.name for each in python(made).declarations]
    assert names.count("/ns/late") == 1
