"""A static variable of a function is one for all calls: singletons."""

import pytest
from ros1_runs import cpp, names

SINGLETON = """
class Manager {
 public:
  static Manager%(by)s getInstance();
  void set(ros::NodeHandle* handle) { handle_ = handle; }
  void join(const std::string& name) { handle_->advertise<std_msgs::Bool>(name, 1); }
 private:
  ros::NodeHandle* handle_;
};
Manager%(by)s Manager::getInstance() { static Manager instance; return %(address)sinstance; }
"""
BY_REFERENCE = SINGLETON % {"by": "&", "address": ""}
BY_POINTER = SINGLETON % {"by": "*", "address": "&"}


@pytest.mark.parametrize(
    ("top", "operator"), [(BY_REFERENCE, "."), (BY_POINTER, "->")], ids=["reference", "pointer"]
)
def test_a_singleton_keeps_what_it_was_given(top, operator):
    get = f"Manager::getInstance(){operator}"
    interface = cpp(f'{get}set(&nh); {get}join("x");', top)
    assert (names(interface), interface.unresolved) == (["x"], ())


def test_a_number_counts_on():
    top = "int next() { static int n = 0; n += 1; return n; }"
    body = (
        'for (int i = 0; i < 2; i++) nh.advertise<std_msgs::Bool>("a" + std::to_string(next()), 1);'
    )
    assert names(cpp(body, top)) == ["a1", "a2"]


def test_each_instance_of_a_template_has_its_own():
    inner = "static std::string s = std::to_string(N); return s;"
    top = f"template<int N> std::string& name() {{ {inner} }}"
    body = 'name<1>(); nh.advertise<std_msgs::Bool>("a" + name<2>(), 1);'
    assert names(cpp(body, top)) == ["a2"]


def test_two_functions_have_two():
    top = 'std::string f() { static std::string s = "f"; return s; }'
    top += 'std::string g() { static std::string s = "g"; return s; }'
    body = "nh.advertise<std_msgs::Bool>(f() + g(), 1);"
    assert names(cpp(body, top)) == ["fg"]
