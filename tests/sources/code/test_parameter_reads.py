"""Which nodes of ROS 2 read their parameters at the start alone."""

import pytest
from ros2_runs import cpp, python

CPP = 'max_ = declare_parameter<double>("max", 1.0);'
CPP_TIMER = f"{CPP} timer_ = create_wall_timer(10ms, std::bind(&N::tick, this));"
PYTHON = "self.top = self.declare_parameter('max', 1.0).value\n"
PYTHON_TIMER = PYTHON + "self.create_timer(0.1, self.tick)\n"


def are_read_once(interface):
    """Return whether each parameter is read once."""
    return [each.read_once for each in interface.parameters if each.name == "max"]


@pytest.mark.parametrize(
    ("body", "members", "once"),
    [
        (CPP, "double max_;", True),
        (CPP_TIMER, "void tick() { move(max_); } double max_;", True),
        (f'{CPP} get_parameter("max", max_);', "double max_;", True),
        (CPP_TIMER, 'void tick() { get_parameter("max", max_); } double max_;', False),
        (CPP_TIMER, 'void tick() { read(); } void read() { get_parameter("max", max_); }', False),
        (f'{CPP} call_ = [this]() {{ get_parameter("max", max_); }};', "double max_;", False),
        (f"{CPP} add_on_set_parameters_callback(std::bind(&N::set, this, _1));", "", False),
        (f"{CPP} handler_ = std::make_shared<rclcpp::ParameterEventHandler>(this);", "", False),
        (f"{CPP} while (rclcpp::ok()) {{ read(); }}",
         'void read() { get_parameter("max", max_); }', False),
    ],
)  # fmt: skip
def test_a_node_of_rclcpp(body, members, once):
    assert are_read_once(cpp(body, members=members)) == [once]


@pytest.mark.parametrize(
    ("body", "members", "once"),
    [
        (PYTHON, "", True),
        (PYTHON_TIMER, "def tick(self):\n    move(self.top)", True),
        (PYTHON_TIMER, "def tick(self):\n    move(self.get_parameter('max').value)", False),
        (PYTHON + "self.create_timer(1, lambda: self.get_parameter('max'))", "", False),
        (PYTHON + "self.add_on_set_parameters_callback(self.set)", "def set(self, p): pass", False),
        (PYTHON + "while go():\n    self.get_parameter('max')", "", False),
    ],
)  # fmt: skip
def test_a_node_of_rclpy(body, members, once):
    assert are_read_once(python(body, members=members)) == [once]


@pytest.mark.parametrize(("made", "once"), [("Plain()", True), ("Plain(), Driver()", False)])
def test_a_class_whose_base_is_not_here_may_be_called_at_any_time(made, once):
    top = "from vendor import Base\nclass Plain: pass\nclass Driver(Base): pass"
    assert are_read_once(python(PYTHON + made, top=top)) == [once]
