"""Places that look like calls of ROS 2's client libraries."""

import pytest

from evaluation.ros2.call_sites import call_sites, parameter_sites


@pytest.mark.parametrize(
    ("line", "kind"),
    [
        ('pub_ = create_publisher<std_msgs::msg::Bool>("x", 1);', "publisher"),
        ('node->template create_publisher<M>("x", 1);', "publisher"),
        ('create_subscription<M>("x", 1, callback);', "subscription"),
        ('lib::create_service<S> ("x", callback);', "service"),
        ('create_action_server<A>("x");', "action server"),
        ('rclcpp_action::create_server<A>(this, "x");', "action server"),
        ('rclcpp_action::create_client<A>(this, "x");', "action client"),
        ('create_action_client<A>("x");', "action client"),
        ('node->create_client<S>("x");', "client"),
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


def test_parameters_that_are_written_out(tmp_path):
    path = tmp_path / "a.cpp"
    calls = 'declare_parameter<double>("a.b", 1.0);\n// declare_parameter("c", 1);\n'
    path.write_text(calls + 'declare_or_get_parameter(\n"d", 1);\ndeclare_parameter(name, 1);\n')
    assert parameter_sites(tmp_path) == {(str(path), 1, "a.b"), (str(path), 3, "d")}


@pytest.mark.parametrize("place", ["test", "my_system_tests/src", "my_rviz_plugins", "benchmark"])
def test_tests_and_panels_are_no_node_sources(tmp_path, place):
    (tmp_path / place).mkdir(parents=True)
    (tmp_path / place / "a.cpp").write_text('create_publisher<M>("x", 1);')
    assert not any(call_sites(tmp_path).values())


CMAKE = "project(p)\nadd_library(${PROJECT_NAME}_core ${PROJECT_NAME}.cpp)\n"


@pytest.mark.parametrize(
    ("file", "cmake", "counts"),
    [
        ("src/p.cpp", CMAKE, True),
        ("src/other.cpp", CMAKE, False),
        ("src/other.cpp", CMAKE + "file(GLOB sources src/*.cpp)", True),
        ("include/other.hpp", CMAKE, True),
        ("scripts/plot.py", CMAKE, False),
        ("scripts/plot.py", CMAKE + "install(PROGRAMS scripts/plot.py)", True),
        ("scripts/plot.py", CMAKE + "install(DIRECTORY scripts DESTINATION lib)", True),
        ("scripts/plot.py", CMAKE + "install(DIRECTORY launch DESTINATION share)", False),
        ("p/node.py", CMAKE, True),
    ],
)
def test_what_no_build_file_names_is_no_node_source(tmp_path, file, cmake, counts):
    path = tmp_path / "p" / file
    path.parent.mkdir(parents=True)
    (tmp_path / "p" / "package.xml").touch()
    (tmp_path / "p" / "CMakeLists.txt").write_text(cmake)
    if file == "p/node.py":
        (path.parent / "__init__.py").touch()
    is_python = path.suffix == ".py"
    call = "n.create_publisher(M)" if is_python else 'create_publisher<M>("x");'
    path.write_text(call)
    assert call_sites(tmp_path)["publisher"] == ({(str(path), 1)} if counts else set())
