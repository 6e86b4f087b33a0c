"""Containers of C++: what is put into them stands in them (cppreference.com: container)."""

import pytest
from ros1_runs import cpp, names

WORKER = """struct Worker {
  ros::Publisher made;
  Worker(ros::NodeHandle & nh, std::string name) { made = nh.advertise<std_msgs::Bool>(name, 1); }
  void go() {}
};"""
EACH = "for (auto & name : names) { nh.advertise<std_msgs::Bool>(name, 1); }"
VALUES = "for (auto & entry : names) { nh.advertise<std_msgs::Bool>(entry.second, 1); }"


@pytest.mark.parametrize(
    "put",
    [
        'std::vector<Worker> all; all.emplace_back(nh, "a"); all.emplace_back(nh, "b");',
        'std::vector<Worker> all; all.push_back({nh, "a"}); all.push_back(Worker(nh, "b"));',
        'std::map<int, Worker> all; all.emplace(1, Worker(nh, "a")); all.try_emplace(2, nh, "b");',
        'std::list<Worker> all; all.emplace_back(nh, "a"); all.emplace(all.end(), nh, "b");',
    ],
)
def test_objects_are_made_in_place(put):
    assert names(cpp(put, WORKER)) == ["a", "b"]


TEXTS = 'std::vector<std::string> v{"a", "b"}, names; '


@pytest.mark.parametrize(
    ("fill", "expected"),
    [
        ('std::deque<std::string> names; names.push_front("a"); names.emplace_front("b");', "ba"),
        ('std::set<std::string> names; names.emplace("a"); names.insert({"b", "c"});', "abc"),
        ('std::vector<std::string> v{"a", "b"}, names(v.begin(), v.end());', "ab"),
        (TEXTS + "names.insert(names.end(), v.begin(), v.end());", "ab"),
        (TEXTS + "names.assign(v.begin(), v.end());", "ab"),
        (TEXTS + "names.swap(v);", "ab"),
        (TEXTS + "std::swap(names, v);", "ab"),
        (TEXTS + "names = std::exchange(v, {});", "ab"),
        (TEXTS + "std::copy(v.begin(), v.end(), std::back_inserter(names));", "ab"),
        (TEXTS + "std::transform(v.begin(), v.end(), std::back_inserter(names), upper);", "AB"),
        (
            TEXTS + "names.resize(2); std::transform(v.begin(), v.end(), names.begin(), upper);",
            "AB",
        ),
    ],
)
def test_items(fill, expected):
    top = """
    bool is_b(const std::string & s) { return s == "b"; }
    std::string upper(const std::string & s) { return s == "a" ? "A" : "B"; }
    #define LOOP std::vector<std::string> names; for (int i : v) names.push_back(std::to_string(i));
    """
    assert names(cpp(fill + EACH, top)) == list(expected)


@pytest.mark.parametrize(
    "fill",
    [
        'names.insert_or_assign(1, "x"); names.insert_or_assign(1, "a");',
        'names.insert({1, "a"}); names.insert({1, "x"});',
        'names[1] = "a"; auto [it, added] = names.emplace(1, "x"); if (added) names[2] = "x";',
        'names.emplace(std::piecewise_construct, std::tie(one), std::forward_as_tuple("a"));',
        'names.insert({{1, "a"}});',
        'names.insert(std::make_pair(1, "a"));',
    ],
)
def test_entries(fill):
    assert names(cpp(f"std::map<int, std::string> names; int one = 1; {fill} {VALUES}")) == ["a"]


@pytest.mark.parametrize(
    "body",
    [
        'std::optional<std::string> o{"a"}; if (o) ADD(*o);',
        'std::optional<std::string> o; if (o) ADD("x"); o = "a"; ADD(o.value());',
        'std::optional<std::string> o; if (o.has_value()) ADD("x"); else ADD("a");',
        'std::optional<std::string> o; ADD(o.value_or("a"));',
        'std::optional<std::string> o = std::nullopt; if (o) ADD("x"); o.emplace("a"); ADD(*o);',
        'std::variant<int, std::string> v = "a"; ADD(std::get<std::string>(v));',
        'std::tuple<int, std::string> t{1, "a"}; ADD(std::get<1>(t));',
        'int n = 4; if (std::max(n, 2) == 4) { ADD("a"); } else { ADD("x"); }',
    ],
)
def test_what_may_be_held_or_called(body):
    top = "#define ADD(name) nh.advertise<std_msgs::Bool>(name, 1)"
    assert names(cpp(body, top)) == ["a"]


def test_threads_run_what_they_are_made_of():
    top = "struct C { ros::NodeHandle nh; void go(std::string n) { ADD(n); } };"
    top = "#define ADD(name) nh.advertise<std_msgs::Bool>(name, 1)\n" + top
    body = 'C c; std::vector<std::thread> all; all.emplace_back(&C::go, &c, "a");'
    assert names(cpp(body + ' std::thread(&C::go, &c, "b").join();', top)) == ["a", "b"]


@pytest.mark.parametrize("made", ["std::vector<std::string> names(300)", "std::string names[300]"])
def test_more_items_than_are_kept_are_not_cut_in_silence(made):
    assert names(cpp(made + '; names[0] = "a"; names[1] = "a";' + EACH))[-1] == "{name}"
