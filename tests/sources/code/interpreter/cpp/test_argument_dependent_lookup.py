"""An unqualified call finds what stands beside the classes of its arguments (cppreference: ADL)."""

import pytest
from ros2_runs import cpp, names

BESIDE = """
namespace tools {
  struct Base {};
  struct Speaker : Base {};
  template <typename T> void speak(T node, const Speaker &) {
    node->template create_publisher<std_msgs::msg::Bool>("spoken", 1); }
  void hear(rclcpp::Node * node, const Base &) {
    node->create_subscription<std_msgs::msg::Bool>("heard", 1, [](auto m) {}); }
}
namespace app {
  struct Mine : tools::Speaker {};
}
"""


@pytest.mark.parametrize(
    ("call", "expected"),
    [
        ("speak(this, tools::Speaker());", ["/ns/spoken"]),
        ("hear(this, app::Mine());", ["/ns/heard"]),
        ("speak(this, 1);", []),
        ("other::speak(this, tools::Speaker());", []),
    ],
)
def test_a_call_finds_the_functions_of_its_arguments_namespaces(call, expected):
    assert names(cpp(call, top=BESIDE)) == expected


def test_what_is_found_has_no_note():
    found = cpp("speak(this, tools::Speaker());", top=BESIDE)
    assert not [note for note in found.unresolved if note.what == "speak()"]
