"""Classes around a subscriber, with overloads, templates and handles that go by reference."""

import pytest
from ros1_runs import cpp, names

WRAPPERS = """
#include <functional>
namespace app {
namespace ros {
template <typename M> class Buffered {
  using Callback = std::function<void(const typename M::ConstPtr&)>;
 public:
  Buffered(const ::ros::NodeHandle& nh) : nh_{nh} {}
  template <typename F, typename T>
  void subscribe(const std::string& topic, uint32_t size, F&& callback, T* object) {
    subscribe(topic, size, std::bind(callback, object, std::placeholders::_1));
  }
  void subscribe(const std::string& topic, uint32_t size, Callback&& callback) {
    callback_ = callback;
    subscriber_ = nh_.subscribe(topic, size, &Buffered<M>::on_message, this);
  }
 protected:
  void on_message(const typename M::ConstPtr& message) {}
  ::ros::NodeHandle nh_;
  ::ros::Subscriber subscriber_;
  Callback callback_;
};
template <typename M> class Timed : private Buffered<M> {
  using Base = Buffered<M>;
 public:
  Timed(const ::ros::NodeHandle& nh) : Base{nh} {}
  void subscribe(const std::string& topic, uint32_t size, const ::ros::Duration timeout) {
    Base::subscribe(topic, size, &Timed<M>::on_timed, this);
  }
 private:
  void on_timed(const typename M::ConstPtr& message) {}
};
}
}
"""


@pytest.mark.parametrize(
    "body",
    [
        'app::ros::Buffered<std_msgs::Bool> s{nh}; s.subscribe("x", 1, nullptr);',
        'app::ros::Timed<std_msgs::Bool> s{nh}; s.subscribe("x", 1, ros::Duration(1.0));',
    ],
)
def test_a_class_around_a_subscriber_is_followed(body):
    found = cpp(body, top=WRAPPERS)
    assert [(each.name, each.type) for each in found.declarations] == [("/ns/x", "std_msgs/Bool")]


def test_a_method_that_overrides_another_is_called_by_its_base():
    top = """
struct Base {
  virtual void make(ros::NodeHandle& nh) { nh.advertise<std_msgs::Bool>("base", 1); }
  void run(ros::NodeHandle& nh) { make(nh); }
};
struct Heir : Base {
  void make(ros::NodeHandle& handle) override { handle.advertise<std_msgs::Bool>("heir", 1); }
};
"""
    assert names(cpp("Heir heir; heir.run(nh);", top=top)) == ["heir"]


def test_a_node_handle_that_another_function_gets_stays_one():
    top = "void load(ros::NodeHandle& nh);"
    assert names(cpp('load(nh); nh.advertise<std_msgs::Bool>("x", 1);', top=top)) == ["x"]
