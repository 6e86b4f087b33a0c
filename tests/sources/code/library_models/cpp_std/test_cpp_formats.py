"""Texts made of a format and values (cppreference.com: std::format; {fmt}; Abseil: strings)."""

import pytest
from ros1_runs import cpp, names


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ('std::format("can/{}/in", std::string{"arm"})', "can/arm/in"),
        ('std::format("{1}_{0}", "a", "b")', "b_a"),
        ('std::format("{:03d}_{:.1f}_{{}}", 7, 2.55)', "007_2.5_{}"),
        ('std::format("{}", true)', "true"),
        ('fmt::format(FMT_STRING("{:>4}"), "x")', "   x"),
        ('std::format("{}_out", find())', "{find()}_out"),
    ],
)
def test_a_name_is_what_the_format_makes(text, expected):
    assert names(cpp(f"nh.advertise<std_msgs::Bool>({text}, 1);")) == [expected]
