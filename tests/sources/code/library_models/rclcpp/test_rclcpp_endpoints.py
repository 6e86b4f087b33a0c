"""What rclcpp's nodes publish, subscribe, serve and call, and the libraries around it."""

import pytest
from ros2_runs import (
    UNLAUNCHED,
    cpp,
    explicit_declarations,
    implicit_declarations,
    names,
    only_declaration,
    python,
    run_text,
)

from rtron.vocabulary import Durability, QoS, Reliability


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        ('create_publisher<std_msgs::msg::Bool>("t", 1)', "publish /ns/t std_msgs/msg/Bool"),
        ('create_subscription<std_msgs::msg::Bool>("t", 1, [](auto m) {})',
         "subscribe /ns/t std_msgs/msg/Bool"),
        ('create_publisher<a_msgs::msg::GoRequest>("t", 1)', "publish /ns/t a_msgs/msg/GoRequest"),
        ('create_service<std_srvs::srv::Empty>("s", [](auto a, auto b) {})',
         "service /ns/s std_srvs/srv/Empty"),
        ('create_client<std_srvs::srv::Empty>("s")', "service_client /ns/s std_srvs/srv/Empty"),
        ('create_generic_publisher("t", "std_msgs/msg/Bool", 1)',
         "publish /ns/t std_msgs/msg/Bool"),
        ('create_generic_subscription("t", "std_msgs/msg/Bool", 1, [](auto m) {})',
         "subscribe /ns/t std_msgs/msg/Bool"),
        ('rclcpp::create_publisher<std_msgs::msg::Bool>(*this, "t", 1)',
         "publish /ns/t std_msgs/msg/Bool"),
        ('rclcpp::create_subscription<std_msgs::msg::Bool>(topics, topics, "t", 1, heard)',
         "subscribe /ns/t std_msgs/msg/Bool"),
        ('rclcpp_action::create_server<a_msgs::action::Dock>(this, "d", 1, 2, 3)',
         "action_server /ns/d a_msgs/action/Dock"),
        ('rclcpp_action::create_client<a_msgs::action::Dock>(topics, topics, topics, "d")',
         "action_client /ns/d a_msgs/action/Dock"),
        ('image_transport::create_subscription(this, "i", [](auto m) {}, "compressed")',
         "subscribe /ns/i/compressed sensor_msgs/msg/CompressedImage"),
        ('message_filters::Subscriber<std_msgs::msg::Bool>(this, "t")',
         "subscribe /ns/t std_msgs/msg/Bool"),
        ('point_cloud_transport::PointCloudTransport(*this).subscribe("t", 1, [](auto m) {})',
         "subscribe /ns/t sensor_msgs/msg/PointCloud2"),
    ],
)  # fmt: skip
def test_each_call_is_found(call, expected):
    body = f"auto topics = get_node_topics_interface(); {call};"
    assert explicit_declarations(cpp(body)) == [expected]


def test_the_type_may_stand_in_the_callback():
    members = "void heard(const nav_msgs::msg::Path::SharedPtr path) {}"
    body = 'create_subscription("t", 1, std::bind(&N::heard, this, std::placeholders::_1));'
    assert only_declaration(cpp(body, members=members)).type == "nav_msgs/msg/Path"


@pytest.mark.parametrize("top", ["using std_msgs::msg::Bool;", "using Bool = std_msgs::msg::Bool;"])
def test_a_type_may_be_brought_by_using(top):
    assert only_declaration(cpp('create_publisher<Bool>("t", 1);', top)).type == "std_msgs/msg/Bool"


ADAPTED = """#include <sensor_msgs/msg/image.hpp>
namespace seen { class Picture {}; }
template<>
struct rclcpp::TypeAdapter<seen::Picture, sensor_msgs::msg::Image> {};
RCLCPP_USING_CUSTOM_TYPE_AS_ROS_MESSAGE_TYPE(seen::Picture, sensor_msgs::msg::Image);
RCLCPP_USING_CUSTOM_TYPE_AS_ROS_MESSAGE_TYPE(std::string, std_msgs::msg::String);
using Adapted = rclcpp::TypeAdapter<std::vector<int>, std_msgs::msg::Int32>;
using namespace seen;
"""


@pytest.mark.parametrize(
    ("call", "type"),
    [
        ('create_publisher<seen::Picture>("t", 1)', "sensor_msgs/msg/Image"),
        ('create_publisher<Picture>("t", 1)', "sensor_msgs/msg/Image"),
        ('create_subscription<std::string>("t", 1, [](auto m) {})', "std_msgs/msg/String"),
        ('create_publisher<Adapted>("t", 1)', "std_msgs/msg/Int32"),
        ('create_publisher<rclcpp::TypeAdapter<int, std_msgs::msg::Int8>>("t", 1)',
         "std_msgs/msg/Int8"),
        ('create_publisher<rclcpp::adapt_type<int>::as<std_msgs::msg::Int8>>("t", 1)',
         "std_msgs/msg/Int8"),
        ('create_subscription("t", 1, [](std::unique_ptr<seen::Picture> m) {})',
         "sensor_msgs/msg/Image"),
    ],
)  # fmt: skip
def test_a_type_of_the_program_is_sent_as_its_message(call, type):
    assert only_declaration(cpp(f"{call};", ADAPTED)).type == type


BEST, TRANSIENT = Reliability.BEST_EFFORT, Durability.TRANSIENT_LOCAL


@pytest.mark.parametrize(
    ("written_qos", "expected"),
    [
        ("7", QoS(depth=7)),
        ("rclcpp::QoS(3)", QoS(depth=3)),
        ("rclcpp::QoS(rclcpp::KeepLast(4)).best_effort()", QoS(depth=4, reliability=BEST)),
        ("rclcpp::QoS(1).transient_local().reliable()", QoS(depth=1, durability=TRANSIENT)),
        ("rclcpp::SensorDataQoS()", QoS(depth=5, reliability=BEST)),
        ("rclcpp::SensorDataQoS().reliable().keep_last(9)", QoS(depth=9)),
        ("rmw_qos_profile_sensor_data", QoS(depth=5, reliability=BEST)),
        ("rclcpp::QoS(2).reliability(rclcpp::ReliabilityPolicy::BestEffort)",
         QoS(depth=2, reliability=BEST)),
        ("depth_of_who_knows()", None),
        ("rclcpp::QoS(2).reliability(what_ever())", None),
    ],
)  # fmt: skip
def test_a_literal_quality_of_service_is_read(written_qos, expected):
    assert (
        only_declaration(cpp(f'create_publisher<std_msgs::msg::Bool>("t", {written_qos});')).qos
        == expected
    )


def test_a_quality_of_service_may_have_a_class_of_its_own():
    top = """class Latched : public rclcpp::QoS {
    public: explicit Latched(const int depth = 2) : rclcpp::QoS(depth) { this->transient_local(); }
    };"""
    found = only_declaration(cpp('create_publisher<std_msgs::msg::Bool>("t", Latched());', top))
    assert found.qos == QoS(depth=2, durability=TRANSIENT)
    assert found.latched


def test_what_a_callback_makes_is_found():
    body = 'create_wall_timer(1s, [this]() { create_publisher<std_msgs::msg::Bool>("late", 1); });'
    assert names(cpp(body)) == ["/ns/late"]


def test_what_a_function_hands_on_is_run_though_nothing_seen_calls_it():
    top = (
        "struct Server { Server(std::function<void()> work) : work_(work) {} void on() { work_(); }"
    )
    top += " std::function<void()> work_; };"
    members = """
    std::shared_ptr<Server> server_;
    void work() { create_subscription<std_msgs::msg::Bool>(asked_, 1, [](auto m) {}); }
    std::string asked_ = "asked";"""
    body = "server_ = std::make_shared<Server>(std::bind(&N::work, this));"
    assert names(cpp(body, top, members)) == ["/ns/asked"]


WRAPPER = """
namespace lib {
template<typename M, typename NodeT>
auto create_publisher(const NodeT & node, const std::string & topic, int depth = 5) {
  return rclcpp::create_publisher<M>(*node, topic, depth);
}
class Twister { public:
  Twister(rclcpp::Node * node, const std::string & topic) {
    bool stamped = node->declare_parameter("stamped", true);
    if (stamped) { lib::create_publisher<geometry_msgs::msg::TwistStamped>(node, topic); }
    else { lib::create_publisher<geometry_msgs::msg::Twist>(node, topic); }
  }
}; }
"""


def test_a_wrapper_is_interpreted_and_the_evidence_begins_where_the_name_is_given():
    found = only_declaration(
        cpp('lib::Twister twister(this, "cmd_vel");', WRAPPER, parameters_complete=True)
    )
    assert (found.name, found.type) == ("/ns/cmd_vel", "geometry_msgs/msg/TwistStamped")
    lines = [place.line for place in found.evidence]
    top = WRAPPER.count("\n")
    assert lines == [top + 7, 11, 6]


def test_without_a_launch_both_types_are_told():
    found = cpp('lib::Twister twister(this, "cmd_vel");', WRAPPER, parameters_complete=False)
    assert [d.type.rpartition("/")[2] for d in found.declarations if not d.implicit] == [
        "TwistStamped",
        "Twist",
    ]


def test_the_last_of_a_list_is_what_either_branch_put_there():
    top = """
    struct Shape { Shape(rclcpp::Node * n, std::string s) : n_(n), s_(s) {}
      virtual bool configure() { n_->create_publisher<a::msg::Shape>(s_, 1); return true; }
      rclcpp::Node * n_; std::string s_; };
    struct Round : public Shape { Round(rclcpp::Node * n, std::string s) : Shape(n, s) {}
      bool configure() override { n_->create_publisher<a::msg::Round>(s_, 1); return true; } };
    """
    body = """
    std::vector<std::shared_ptr<Shape>> shapes;
    const std::string type = declare_parameter<std::string>("type");
    if (type == "shape") { shapes.push_back(std::make_shared<Shape>(this, "a")); }
    else if (type == "round") { shapes.push_back(std::make_shared<Round>(this, "b")); }
    else { return; }
    shapes.back()->configure();
    """
    assert names(cpp(body, top, parameters_complete=False)) == ["/ns/a", "/ns/b"]


def test_one_of_several_that_throws_ends_nothing():
    top = """struct Base { virtual void on() {} };
    struct Bad : public Base { void on() override { throw std::runtime_error("no"); } };"""
    body = """
    std::shared_ptr<Base> base = std::make_shared<Base>();
    if (who_knows()) { base = std::make_shared<Bad>(); }
    try { base->on(); create_publisher<std_msgs::msg::Bool>("behind", 1); }
    catch (const std::exception & e) { return; }
    """
    assert names(cpp(body, top)) == ["/ns/behind"]


EVERY = {
    "publish /rosout",
    "publish /parameter_events",
    "subscribe /parameter_events",
    *(
        f"service /ns/n/{name}"
        for name in (
            "describe_parameters",
            "get_parameter_types",
            "get_parameters",
            "list_parameters",
            "set_parameters",
            "set_parameters_atomically",
            "get_type_description",
        )
    ),
}


def test_what_every_node_declares_is_marked():
    assert implicit_declarations(cpp("")) == EVERY
    assert implicit_declarations(python("pass")) == EVERY - {"subscribe /parameter_events"}


PARAMETERS = sorted(name for name in EVERY if "parameter" in name and name.startswith("service"))
LEVELS = {f"service /other/{name}_logger_levels" for name in ("get", "set")}


@pytest.mark.parametrize("on", [True, False])
def test_the_services_of_loggers_are_there_where_they_are_asked_for(on):
    options = f"rclcpp::NodeOptions().enable_logger_service({str(on).lower()})"
    found = implicit_declarations(cpp(f'rclcpp::Node n("other", {options});', **UNLAUNCHED))
    assert {name for name in found if "logger" in name} == (LEVELS if on else set())
    found = implicit_declarations(
        python(f"Node('other', enable_logger_service={on})", **UNLAUNCHED)
    )
    assert {name for name in found if "logger" in name} == (LEVELS if on else set())


@pytest.mark.parametrize(
    ("arguments", "node"),
    [("this", "/ns/n"), ('this, ""', "/ns/n"), ('this, "far"', "/ns/far"), ('this, "/a"', "/a")],
)
@pytest.mark.parametrize("kind", ["Async", "Sync"])
def test_a_client_of_parameters_calls_the_services_of_a_node_or_its_own(kind, arguments, node):
    found = implicit_declarations(cpp(f"rclcpp::{kind}ParametersClient c({arguments});")) - EVERY
    assert sorted(found) == [
        name.replace("service /ns/n", f"service_client {node}") for name in PARAMETERS
    ]


@pytest.mark.parametrize(
    ("made", "added"),
    [
        ("tf2_ros::TransformBroadcaster b(this)", {"publish /tf"}),
        ("tf2_ros::StaticTransformBroadcaster b(*this)", {"publish /tf_static"}),
        ("tf2_ros::TransformListener l(buffer, this)", {"subscribe /tf", "subscribe /tf_static"}),
        (
            "tf2_ros::TransformListener l(buffer)",
            {
                "subscribe /tf",
                "subscribe /tf_static",
                *("publish /rosout", "publish /parameter_events"),
            },
        ),
        ("tf2_ros::Buffer b(clock, seconds, this)", {"service /ns/tf2_frames"}),
        ("diagnostic_updater::Updater u(this)", {"publish /diagnostics"}),
        ('bond::Bond b("bond", "id", this)', {"publish /ns/bond", "subscribe /ns/bond"}),
        ("camera_info_manager::CameraInfoManager c(this)", {"service /ns/n/set_camera_info"}),
        (
            'interactive_markers::InteractiveMarkerServer m("menu", this)',
            {
                "publish /ns/menu/update",
                "subscribe /ns/menu/feedback",
                "service /ns/menu/get_interactive_markers",
            },
        ),
    ],
)
def test_what_a_library_declares_is_marked(made, added):
    assert implicit_declarations(cpp(f"{made};")) == EVERY | added


def test_a_listener_without_a_node_has_one_of_its_own():
    nodes = [node.name for node in cpp("tf2_ros::TransformListener l(buffer);").nodes]
    assert nodes == ["/ns/n", "/ns/transform_listener_impl_{id}"]


def test_a_call_on_what_may_be_a_node_is_noted():
    text = """int main() {
      rclcpp::create_publisher<std_msgs::msg::Bool>(somebody(), "t", 1);
    }"""
    found = run_text(text)
    assert names(found) == []
    assert [note.what for note in found.unresolved] == ["publish(t)"]
