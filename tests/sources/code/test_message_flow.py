"""What a node sends, calls or asks for because of a message, in both languages."""

import pytest
import ros1_runs
import ros2_runs

from rtron.sources.declaration import FlowInput
from rtron.vocabulary import UNKNOWN_OUTPUT

PYTHON = """import rospy
from std_msgs.msg import Float32, String
from std_srvs.srv import Empty
from motor_board import Kit


class Node:
    def __init__(self):
        self.mode, self.seen = '', ''
        self.kit = Kit()
        self.motor = rospy.Publisher('motor', Float32, queue_size=1)
        self.report = rospy.Publisher('report', String, queue_size=1)
        self.home = rospy.ServiceProxy('go_home', Empty)
        rospy.Subscriber('order', {type}, self.on_order)
        rospy.Timer(rospy.Duration(0.1), self.tick)

    def on_order(self, message):
{callback}

    def tick(self, event):
{timer}

    def drive(self, speed):
        self.motor.publish(speed)

    def is_on(self):
        return self.mode == 'on'


rospy.init_node('n')
Node()
rospy.spin()
"""
REPORT = "self.report.publish('fine')"


def python(callback, timer="pass", type="String"):
    """Return what the order leads to, None where that is not known."""
    return led(run(callback, timer, type))


def run(callback, timer="pass", type="String"):
    blocks = (
        "\n".join(f"        {row}" for row in text.splitlines()) for text in (callback, timer)
    )
    text = PYTHON.format(type=type, **dict(zip(("callback", "timer"), blocks, strict=True)))
    return ros1_runs.run_text(text)


def told(interface):
    """Return the flows of what is received."""
    return [each for each in interface.message_flows if each.input is not FlowInput.START]


def led(interface):
    at = {(d.kind.value, d.evidence[0]): d.name for d in interface.declarations}
    flows = [each for each in told(interface) if each.outputs != (UNKNOWN_OUTPUT,)]
    names = [at["publish", place] for flow in flows for place in flow.evidence[1:]]
    found = sorted(each.rpartition("/")[2] for flow in flows for each in (*names, *flow.requests))
    return found if flows else None


@pytest.mark.parametrize(
    ("callback", "timer", "found"),
    [
        ("self.motor.publish(1.0)", REPORT, ["motor"]),
        ("self.drive(len(message.data))", REPORT, ["motor"]),
        ("if message.data == 'home': self.home()", "pass", ["go_home"]),
        ("self.mode = message.data", f"self.drive(len(self.mode))\n{REPORT}", ["motor"]),
        ("self.mode = message.data", f"if self.mode == 'on': self.drive(1)\n{REPORT}", ["motor"]),
        ("self.mode = message.data", "if not self.mode: return\nself.drive(1)", ["motor"]),
        ("self.mode = message.data", f"if self.is_on(): self.drive(1)\n{REPORT}", ["motor"]),
        ("self.mode = message.data", "self.report.publish(self.mode)", ["report"]),
        ("self.mode = message.data", "a, b = self.mode, 1\nself.drive(a)", ["motor"]),
        ("self.mode = message.data", "for a in self.mode: self.drive(1)", ["motor"]),
    ],
)
def test_in_python(callback, timer, found):
    assert python(callback, timer) == found


@pytest.mark.parametrize(
    "callback",
    [
        "pass",
        "rospy.loginfo(message.data)",
        "logging.getLogger('n').warning(message.data)",
        "print(message.data)",
        "x = message.data",
    ],
)
def test_what_is_not_used(callback):
    assert python(callback) == []


@pytest.mark.parametrize(
    "callback",
    ["self.seen = message.data", "del self.seen", "write(message.data)"],
)
def test_what_may_do_something_else_is_not_known(callback):
    assert python(callback) is None


@pytest.mark.parametrize(
    ("callback", "timer", "output"),
    [
        ("self.kit.error(message.data)", "pass", "motor_board.Kit"),
        ("self.kit.servo[1].angle = message.data", "pass", "motor_board.Kit"),
        ("if message.data == 'go': self.kit.forward()", "pass", "motor_board.Kit"),
        ("self.mode = message.data", "self.kit.write(self.mode)", "motor_board.Kit"),
        ("self.mode = message.data", "if self.is_on(): self.kit.go()", "motor_board.Kit"),
        ("port = Kit()\nport.send(message.data)", "pass", "motor_board.Kit"),
        ("self.mode = message.data", "self.kit.blink()", ""),
        ("self.mode = self.kit.read_mode(message.data)", "pass", ""),
        ("self.kit = message.data", "pass", ""),
        ("self.seen.append(message.data)", "pass", ""),
        ("json.dumps(message.data)", "pass", ""),
        ("write(message.data)", "pass", ""),
        ("self.report.publish(message.data)", "self.kit.blink()", ""),
    ],
)
def test_a_message_is_given_to_a_library(callback, timer, output):
    outputs = {each for flow in told(run(callback, timer)) for each in flow.outputs}
    assert outputs - {UNKNOWN_OUTPUT} == ({output} if output else set())


def test_another_class_gets_it_by_a_function_that_returns_it():
    top = """
struct Listener {
  void on_order(const std_msgs::msg::String & message) { mode_ = message.data; }
  std::string mode() { return mode_; }
  std::string mode_;
};
"""
    members = """
  void tick() { port_.transmit(listener_.mode()); }
  Listener listener_;
  serial::Serial port_;
"""
    body = """
    auto sub = create_subscription<std_msgs::msg::String>("order", 1,
      [this](const std_msgs::msg::String & m) { listener_.on_order(m); });
    auto timer = create_wall_timer(50ms, std::bind(&N::tick, this));
"""
    (flow,) = told(ros2_runs.cpp(body, top=top, members=members))
    assert flow.outputs == ("serial::Serial",)


def test_a_joystick_of_ros_2_commands():
    body = """
    auto sub = create_subscription<sensor_msgs::msg::Joy>("joy", 1,
      [this](const sensor_msgs::msg::Joy & m) { write(fd_, &m.axes[0], 4); });
    fd_ = open("/dev/ttyUSB0", O_RDWR);
"""
    (flow,) = told(ros2_runs.cpp(body, members="  int fd_;"))
    assert flow.outputs == ("open()",)


def test_in_cpp():
    members = """
  void on_order(const std_msgs::msg::String & message) { mode_ = message.data; }
  void tick() { if (mode_.empty()) { return; } drive(1.0); }
  void drive(double speed) { std_msgs::msg::Float32 m; m.data = speed; motor_->publish(m); }
  void beat() { report_->publish(std_msgs::msg::String()); }
  std::string mode_;
  rclcpp::Publisher<std_msgs::msg::Float32>::SharedPtr motor_;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr report_;
"""
    body = """
    motor_ = create_publisher<std_msgs::msg::Float32>("motor", 1);
    report_ = create_publisher<std_msgs::msg::String>("report", 1);
    auto sub = create_subscription<std_msgs::msg::String>("order", 1,
      [this](const std_msgs::msg::String & m) { on_order(m); });
    auto timer = create_wall_timer(50ms, std::bind(&N::tick, this));
    auto other = create_wall_timer(50ms, std::bind(&N::beat, this));
"""
    assert led(ros2_runs.cpp(body, members=members)) == ["motor"]


def test_a_stream_that_a_message_is_written_to_does_something():
    members = """
  void on_order(const std_msgs::msg::String & message) { port_ << message.data << ' '; }
  std::ofstream port_;
"""
    body = """
    auto sub = create_subscription<std_msgs::msg::String>("order", 1,
      std::bind(&N::on_order, this, std::placeholders::_1));
"""
    assert led(ros2_runs.cpp(body, members=members)) is None


def test_a_method_of_ones_own_may_be_called_as_its_librarys():
    text = PYTHON.replace("self.kit = Kit()", "self.kit = Wheel()").replace(
        "class Node:",
        """class Wheel:
    def __init__(self):
        self.kit = Kit()

    def set_speed(self, speed):
        self.kit.set_speed(speed)


class Node:""",
    )
    text = text.format(
        type="String", callback="        self.kit.set_speed(message.data)", timer="        pass"
    )
    (flow,) = told(ros1_runs.run_text(text))
    assert flow.outputs == ("motor_board.Kit",)


def test_what_a_function_writes_to_what_it_is_given():
    members = """
  void on_order(const std_msgs::msg::String & message) { mode_ = message.data; }
  bool copy(std::string & found) { found = mode_; return true; }
  void tick() {
    std::string now;
    copy(now);
    std_msgs::msg::String m; m.data = now; motor_->publish(m);
  }
  std::string mode_;
  rclcpp::Publisher<std_msgs::msg::String>::SharedPtr motor_;
"""
    body = """
    motor_ = create_publisher<std_msgs::msg::String>("motor", 1);
    auto sub = create_subscription<std_msgs::msg::String>("order", 1,
      std::bind(&N::on_order, this, std::placeholders::_1));
    auto timer = create_wall_timer(50ms, std::bind(&N::tick, this));
"""
    assert led(ros2_runs.cpp(body, members=members)) == ["motor"]


def test_what_a_service_leads_to():
    text = PYTHON.replace(
        "rospy.Timer", "rospy.Service('go', Empty, self.on_order)\n        rospy.Timer"
    )
    text = text.format(type="String", callback="        self.drive(1)", timer="        pass")
    requests = [each for each in told(ros1_runs.run_text(text)) if each.requests]
    assert [(each.input, each.requests) for each in requests] == [(FlowInput.REQUEST, ("/ns/go",))]
    assert len(requests[0].evidence) == 2


@pytest.mark.parametrize(
    ("callback", "timer", "moves"),
    [
        ("pass", "self.kit.turn(20)", True),
        ("pass", "self.kit.servo[1].angle = 20", True),
        ("pass", "self.kit.turn(0)", False),
        ("pass", "self.kit.stop(20)", False),
        ("pass", "self.kit.set_frequency(20)", False),
        ("self.mode = message.data", "self.kit.turn(self.mode)", False),
        ("self.mode = message.data", "if self.mode: self.kit.turn(20)", False),
        ("self.kit.turn(message.data)", "pass", False),
    ],
)
def test_what_moves_though_nothing_tells_it_to(callback, timer, moves):
    flows = run(callback, timer).message_flows
    started = [each.outputs for each in flows if each.input is FlowInput.START]
    assert started == [("motor_board.Kit",)] * moves
