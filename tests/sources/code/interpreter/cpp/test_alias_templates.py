"""Alias templates mean a type with their arguments in the place of their parameters."""

import pytest
from ros1_runs import cpp, names

TOP = """
template <typename T> using Handles = std::list<T>;
template <typename K, typename T> using Pairs = std::map<std::string, T>;
template <typename T> using Same = T;
struct Handle {
  ros::Publisher pub;
  explicit Handle(std::string name) { pub = ros::NodeHandle().advertise<std_msgs::Bool>(name, 1); }
};
using All = Handles<Handle>;
template <typename T> void fill(Handles<T> & handles) { handles.emplace_back("filled"); }
"""


@pytest.mark.parametrize(
    ("body", "made"),
    [
        ('Handles<Handle> all; all.emplace_back("a");', "a"),
        ('auto all = std::make_shared<All>(); all->emplace_back("b");', "b"),
        ("All all; fill(all);", "filled"),
        ('Pairs<int, Handle> all; all.emplace("x", "d");', "d"),
        ('Same<Handle> one("e");', "e"),
    ],
)
def test_the_elements_are_of_the_argument(body, made):
    assert names(cpp(body, TOP)) == [made]
