"""Nav2's helpers in nodes of others, whose own source is not here."""

import pytest
from ros2_runs import cpp, explicit_declarations, names

CLIENT = "nav2_util::ServiceClient<std_srvs::srv::SetBool>"


@pytest.mark.parametrize("space", ["nav2_util", "nav2"])
def test_a_service_client(space):
    client = CLIENT.replace("nav2_util", space)
    interface = cpp(f'auto c = std::make_shared<{client}>("go", shared_from_this());')
    assert explicit_declarations(interface) == ["service_client /ns/go std_srvs/srv/SetBool"]


def test_one_that_a_callback_makes_in_a_function_without_another_call_of_rclcpp():
    members = f'void later() {{ c_ = std::make_shared<{CLIENT}>("go", shared_from_this()); }}'
    members += f"std::shared_ptr<{CLIENT}> c_;"
    interface = cpp("create_wall_timer(0s, [this]() { later(); });", members=members)
    assert names(interface) == ["/ns/go"]


def test_an_action_server_and_what_its_callback_makes():
    server = "nav2_util::SimpleActionServer<nav2_msgs::action::Spin>"
    members = 'void run() { create_publisher<std_msgs::msg::Bool>("made", 1); }'
    body = f'auto s = std::make_unique<{server}>(this, "spin", [this]() {{ run(); }});'
    assert names(cpp(body, members=members)) == ["/ns/spin", "/ns/made"]


def test_what_gets_a_node_and_is_not_here_is_noted():
    interface = cpp("auto d = std::make_shared<vendor::Driver>(shared_from_this());")
    assert [note.what for note in interface.unresolved] == ["vendor::Driver()"]


def test_what_runs_a_node_is_not_noted():
    interface = cpp("rclcpp::spin(shared_from_this()); executor_.add_node(shared_from_this());")
    assert interface.unresolved == ()
