"""Objects that C++ makes of another one of their class."""

import pytest
import ros2_runs

TYPES = """struct Plain { std::string name; int count; };
struct Default { Default() { name = "x"; } std::string name; };
struct Own { explicit Own(std::string s) : name(s) {} Own(const Own & o) { name = o.name + "_"; }
  std::string name; };
template <typename T> struct Held { explicit Held(const T & given) : held_(given), braced_{given} {}
  T held_; T braced_; };"""
MADE = "create_publisher<std_msgs::msg::Bool>({}.name, 1);"


@pytest.mark.parametrize(
    "copy", ["{0} b(a);", "{0} b{{a}};", "{0} b = a;", "auto b = {0}(a);", "Held<{0}> h(a);"]
)
@pytest.mark.parametrize("type", ["Plain", "Default"])
def test_a_copy_has_what_the_other_has_at_that_time(copy, type):
    body = f'{type} a; a.name = "n"; {copy.format(type)} a.name = "later";'
    made = ("h.held_", "h.braced_") if "Held" in copy else ("b",)
    found = ros2_runs.cpp(body + "".join(map(MADE.format, made)), top=TYPES)
    assert ros2_runs.names(found) == ["/ns/n"]


def test_a_constructor_that_copies_runs():
    found = ros2_runs.cpp('Own a("n"); Own b(a); ' + MADE.format("b"), top=TYPES)
    assert ros2_runs.names(found) == ["/ns/n_"]
