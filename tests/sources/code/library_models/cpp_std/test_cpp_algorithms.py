"""std::find and its kin decide over lists that are known (cppreference.com: algorithm)."""

import pytest
from ros2_runs import cpp, names

WORDS = """
std::vector<std::string> words = {{"-r", "__node:=old"}};
auto is_new = [](const std::string & word) {{ return word == "new"; }};
auto is_name = [](const std::string & word) {{
  return word.find("__node") != std::string::npos; }};
auto it = {find};
if (it != words.end()) {{ *it = "new"; }} else {{ words.push_back("added"); }}
for (const auto & word : words) {{ create_publisher<std_msgs::msg::Bool>(word, 1); }}
"""


@pytest.mark.parametrize(
    ("find", "expected"),
    [
        ("std::find_if(words.begin(), words.end(), is_name)", ["/ns/-r", "/ns/new"]),
        ("std::find_if_not(words.begin(), words.end(), is_name)", ["/ns/new", "/ns/__node:=old"]),
        ('std::find(words.begin(), words.end(), "-r")', ["/ns/new", "/ns/__node:=old"]),
        (
            "std::find_if(words.begin(), words.end(), is_new)",
            ["/ns/-r", "/ns/__node:=old", "/ns/added"],
        ),
    ],
)
def test_an_item_is_found_and_replaced_where_it_stands(find, expected):
    assert names(cpp(WORDS.format(find=find))) == expected


def test_an_iterator_is_moved_and_not_written_through():
    body = """
    std::vector<std::string> words = {"a", "b"};
    auto it = words.begin();
    it = std::find(words.begin(), words.end(), "b");
    ++it;
    if (it == words.end()) { create_publisher<std_msgs::msg::Bool>("last", 1); }
    for (auto & word : words) { create_publisher<std_msgs::msg::Bool>(word, 1); }
    """
    assert names(cpp(body)) == ["/ns/last", "/ns/a", "/ns/b"]


@pytest.mark.parametrize(
    ("algorithm", "expected"),
    [("any_of", True), ("all_of", False), ("none_of", False)],
)
def test_what_holds_of_a_known_list_is_decided(algorithm, expected):
    body = f"""
    std::vector<std::string> words = {{"a", "b"}};
    bool holds = std::{algorithm}(
      words.begin(), words.end(), [](auto word) {{ return word == "b"; }});
    create_publisher<std_msgs::msg::Bool>(holds ? "yes" : "no", 1);
    """
    assert names(cpp(body)) == ["/ns/yes" if expected else "/ns/no"]


def test_what_is_not_known_decides_nothing():
    body = """
    std::vector<std::string> words = {"a", read_word()};
    bool holds = std::all_of(words.begin(), words.end(), [](auto word) { return word == "a"; });
    if (holds) { create_publisher<std_msgs::msg::Bool>("yes", 1); }
    else { create_publisher<std_msgs::msg::Bool>("no", 1); }
    if (std::find(words.begin(), words.end(), "b") == words.end()) {
      create_publisher<std_msgs::msg::Bool>("absent", 1); }
    """
    assert names(cpp(body)) == ["/ns/yes", "/ns/no", "/ns/absent"]
