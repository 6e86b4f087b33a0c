"""Places that look like calls of ROS 2's client libraries."""

import pytest

from evaluation.ros2.call_sites import call_sites


@pytest.mark.parametrize(
    ("line", "kind"),
    [
        ('pub_ = create_publisher<std_msgs::msg::Bool>("x", 1);', "publisher"),
        ('node->template create_publisher<M>("x", 1);', "publisher"),
        ('create_subscription<M>("x", 1, callback);', "subscription"),
        ('lib::create_service<S> ("x", callback);', "service"),
        ('create_action_server<A>("x");', "action server"),
        ('// create_publisher<M>("x", 1);', ""),
        ('auto s = "create_publisher<M>(";', "publisher"),
        ("create_publisher(const std::string & topic)", ""),
    ],
)
def test_cpp(tmp_path, line, kind):
    path = tmp_path / "a.cpp"
    path.write_text(f"/* one\ntwo */\n{line}\n")
    found = {name: sites for name, sites in call_sites(tmp_path).items() if sites}
    assert found == ({kind: {(str(path), 3)}} if kind else {})


def test_python(tmp_path):
    path = tmp_path / "a.py"
    path.write_text("# self.create_publisher(M, 'x', 1)\nself.create_publisher(M, 'x', 1)\n")
    assert call_sites(tmp_path)["publisher"] == {(str(path), 2)}


@pytest.mark.parametrize("place", ["test", "my_system_tests/src", "my_rviz_plugins", "benchmark"])
def test_tests_and_panels_are_no_node_sources(tmp_path, place):
    (tmp_path / place).mkdir(parents=True)
    (tmp_path / place / "a.cpp").write_text('create_publisher<M>("x", 1);')
    assert not any(call_sites(tmp_path).values())
