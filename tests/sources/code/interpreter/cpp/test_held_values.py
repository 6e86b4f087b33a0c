"""What std::optional, std::variant and std::any hold is made in place (cppreference.com)."""

import pytest
from ros1_runs import cpp, names

ENDS = """
struct One { ros::Publisher made;
  One(ros::NodeHandle const & nh, std::string name)
  : made{nh.advertise<std_msgs::Bool>(name + "_one", 1)} {} };
template <typename T> struct Two { ros::Publisher made;
  Two(ros::NodeHandle const & nh, std::string name)
  : made{nh.advertise<std_msgs::Bool>(name + "_two", 1)} {} };
using Either = std::variant<One, Two<int>, Two<double>>;
struct Holder { std::optional<One> held;
  void fill(ros::NodeHandle nh) { held.emplace(nh, "a"); } };
"""


@pytest.mark.parametrize(
    ("body", "expected"),
    [
        (
            """std::map<int, Either> m; m.try_emplace(1, std::in_place_type<One>, nh, "a");
            m.try_emplace(2, std::in_place_type<Two<int>>, nh, "b");""",
            ["a_one", "b_two"],
        ),
        ('std::vector<Either> v; v.emplace_back(std::in_place_type<One>, nh, "a");', ["a_one"]),
        ('Either e{std::in_place_index<1>, nh, "a"};', ["a_two"]),
        ('Either e; e.emplace<Two<double>>(nh, "a");', ["a_two"]),
        ('Either e; e.emplace<1>(nh, "a");', ["a_two"]),
        ('std::optional<One> o; o.emplace(nh, "a");', ["a_one"]),
        ('std::optional<One> o{std::in_place, nh, "a"};', ["a_one"]),
        ('auto o = std::make_optional<One>(nh, "a");', ["a_one"]),
        ('std::any a = std::make_any<One>(nh, "a");', ["a_one"]),
        ("Holder h; h.fill(nh);", ["a_one"]),
        ("Holder h; h.held.emplace(nh, std::string{'a'});", ["a_one"]),
        (
            """std::optional<One> o; o.emplace(One{nh, "a"});
            if (o.has_value()) { nh.advertise<std_msgs::Bool>("b", 1); }""",
            ["a_one", "b"],
        ),
    ],
)
def test_what_is_held_is_made_of_the_arguments(body, expected):
    assert names(cpp(body, ENDS)) == expected


def test_a_base_is_made_by_a_name_that_means_it():
    top = """
    template <typename T, typename D> struct Base { ros::NodeHandle nh; ros::Publisher made;
      Base(ros::NodeHandle const & n, std::string name)
      : nh{n}, made{nh.advertise<std_msgs::Bool>(name, 1)} {} };
    template <typename T> class Derived final : public Base<T, Derived<T>> {
      using Parent = Base<T, Derived>; using Parent::nh; public:
      Derived(ros::NodeHandle const & n, std::string name) : Parent{n, std::move(name)} {
        nh.advertise<std_msgs::Bool>("derived", 1); } };
    """
    assert names(cpp('Derived<int> d{nh, "base"};', top)) == ["base", "derived"]
