"""Names that callbacks may change: the one that the node is launched with counts."""

import pytest
from ros2_runs import cpp, explicit_declarations, python, settings

AGAIN = "a callback may make it again while it runs, under a name that is not known before"
PYTHON = """
self.topic = self.declare_parameter('topic', 'scan').value
self.join()
self.{add}(self.changed)
"""
MEMBERS = """
def join(self):
    self.sub = self.create_subscription(Bool, self.topic, self.heard, 1)

def heard(self, message):
    pass

def changed(self, parameters):
    for one in parameters:
        if one.name == 'topic':
            self.topic = one.value
            self.join()
"""
CPP = """
topic_ = declare_parameter<std::string>("topic", "scan");
join();
{watch}
"""
CHANGES = """[this](const std::vector<rclcpp::Parameter> & parameters) {
  for (const auto & one : parameters) { topic_ = one.as_string(); join(); } }"""
ONE = """events_ = std::make_shared<rclcpp::ParameterEventHandler>(this);
handle_ = events_->add_parameter_callback("topic", [this](const rclcpp::Parameter & one) {
  topic_ = one.as_string(); join(); });"""
CPP_MEMBERS = """
void join() {
  sub_ = create_subscription<std_msgs::msg::Bool>(topic_, 1,
    [this](std_msgs::msg::Bool::ConstSharedPtr heard) { other(heard->name); });
}
void other(const std::string & name) { pub_ = create_publisher<std_msgs::msg::Bool>(name, 1); }
std::string topic_;
"""


@pytest.mark.parametrize(
    "add", ["add_on_set_parameters_callback", "add_post_set_parameters_callback"]
)
def test_a_topic_that_a_parameter_may_change_has_its_first_name(add):
    found = python(PYTHON.format(add=add), members=MEMBERS, settings=settings(topic="front"))
    assert explicit_declarations(found) == ["subscribe /ns/front std_msgs/msg/Bool"]
    (note,) = found.unresolved
    assert (note.what, note.why) == ("subscribe /ns/front of /ns/n", AGAIN)


@pytest.mark.parametrize("watch", [f"handle_ = add_on_set_parameters_callback({CHANGES});", ONE])
def test_in_cpp_it_is_the_same_and_a_name_in_a_message_stays_a_hole(watch):
    found = cpp(CPP.format(watch=watch), members=CPP_MEMBERS)
    assert explicit_declarations(found) == [
        "subscribe /ns/scan std_msgs/msg/Bool",
        "publish /ns/{name} std_msgs/msg/Bool",
    ]
    (note,) = found.unresolved
    assert (note.what, note.why) == ("subscribe /ns/scan of /ns/n", AGAIN)


def test_a_member_that_a_callback_reads_again_is_the_same_endpoint():
    body = """
    topic_ = declare_parameter<std::string>("topic", "scan");
    sub_ = create_subscription<std_msgs::msg::Bool>(topic_, 1, [](auto) {});
    reset_ = create_service<std_srvs::srv::Empty>("reset", [this](auto, auto) {
      sub_ = create_subscription<std_msgs::msg::Bool>(topic_, 1, [](auto) {}); });
    rename_ = create_subscription<std_msgs::msg::String>("rename", 1,
      [this](std_msgs::msg::String::ConstSharedPtr heard) { topic_ = heard->data; });
    """
    found = cpp(body, members="std::string topic_;")
    assert explicit_declarations(found) == [
        "subscribe /ns/scan std_msgs/msg/Bool",
        "service /ns/reset std_srvs/srv/Empty",
        "subscribe /ns/rename std_msgs/msg/String",
    ]
    assert [note.why for note in found.unresolved] == [AGAIN]


def test_what_a_change_of_parameters_makes_for_the_first_time_is_in_the_graph():
    body = f"handle_ = add_on_set_parameters_callback({CHANGES});"
    found = cpp(body, members=CPP_MEMBERS)
    assert explicit_declarations(found)[0] == "subscribe /ns/{as_string()} std_msgs/msg/Bool"


ASKED = """
class Tool { public: virtual ~Tool() = default; virtual void grasp() = 0; };
class Hand : public Tool {
public:
  explicit Hand(rclcpp::Node * node) : node_(node) {}
  void grasp() override { node_->create_publisher<std_msgs::msg::Bool>("hand", 1); }
  void never() { node_->create_publisher<std_msgs::msg::Bool>("never", 1); }
  rclcpp::Node * node_;
};
"""


def test_a_method_that_is_called_of_an_unknown_object_runs_on_the_one_that_there_is():
    body = """
    Hand hand(this); keep(&hand);
    sub_ = create_subscription<std_msgs::msg::String>("name", 1,
      [this](std_msgs::msg::String::ConstSharedPtr name) { look_up(name->data)->grasp(); });
    """
    assert explicit_declarations(cpp(body, top=ASKED)) == [
        "subscribe /ns/name std_msgs/msg/String",
        "publish /ns/hand std_msgs/msg/Bool",
    ]
