"""What C++ lambdas take by copy is as it was where they were made, what they share as it is."""

import pytest
from ros1_runs import cpp, names

MADE = 'std::string a = "early", b = "b"; auto f = {lambda_}; a = "late"; b = "c"; f({given});'
PUBLISH = "nh.advertise<std_msgs::Bool>({}, 1);"


@pytest.mark.parametrize(
    ("captures", "said", "fake_study"),
    [
        ("&", "a", "late"),
        ("=", "a", "early"),
        ("a, &nh", "a", "early"),
        ("&a, &nh", "a", "late"),
        ("=, &a", "a + b", "lateb"),
        ("&, a", "a + b", "earlyc"),
        ("n = a, &nh", "n", "early"),
        ("&n = a, &nh", "n", "late"),
        ('&, n = a + "_x"', "n + a", "early_xlate"),
    ],
)
def test_a_capture_is_a_copy_or_the_place_itself(captures, said, fake_study):
    body = f"[{captures}]() {{ {PUBLISH.format(said)} }}"
    assert names(cpp(MADE.format(lambda_=body, given=""))) == [fake_study]


def test_a_parameter_hides_what_is_taken_by_copy():
    body = f"[=](std::string a) {{ {PUBLISH.format('a')} }}"
    assert names(cpp(MADE.format(lambda_=body, given='"given"'))) == ["given"]


def test_a_lambda_in_a_lambda_has_the_copies_of_the_outer_one():
    inner = f"[=]() {{ {PUBLISH.format('a')} }}"
    assert names(cpp(MADE.format(lambda_=f"[=]() {{ auto g = {inner}; g(); }}", given=""))) == [
        "early"
    ]


def test_each_lambda_of_a_loop_keeps_its_own():
    body = f"""std::vector<std::function<void()>> all;
    for (int i = 0; i < 3; ++i) all.push_back([i, &nh] {{ {PUBLISH.format("std::to_string(i)")} }});
    for (auto& one : all) one();"""
    assert names(cpp(body)) == ["0", "1", "2"]


def test_a_copied_list_does_not_grow_with_the_first_one():
    body = f"""std::vector<std::string> all = {{"one"}};
    auto f = [all, &nh] {{ for (auto& n : all) {PUBLISH.format("n")} }};
    all.push_back("two");
    f();"""
    assert names(cpp(body)) == ["one"]


def test_what_a_mutable_lambda_writes_stays_with_it():
    body = f"""std::string a = "x";
    auto f = [a, &nh]() mutable {{ a += "y"; {PUBLISH.format("a")} }};
    f();
    {PUBLISH.format("a")}"""
    assert names(cpp(body)) == ["xy", "x"]


def test_members_are_shared_through_this():
    top = f"""struct N {{
      std::string m = "early";
      void go(ros::NodeHandle& nh) {{
        auto f = [=, &nh] {{ {PUBLISH.format("m")} }};
        m = "late";
        f();
      }}
    }};"""
    assert names(cpp("N n; n.go(nh);", top)) == ["late"]
