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
    ("algorithm", "expected"), [("any_of", True), ("all_of", False), ("none_of", False)]
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


LETTERS = {
    "for (auto & c : text) c = toupper(c);": ["/ns/ABC"],
    "for (auto & c : text) { c = std::toupper(c); }": ["/ns/ABC"],
    "for (auto c : text) c = toupper(c);": ["/ns/aBc"],
    "for (auto & c : text) { c = who(c); }": ["/ns/{text}"],
    "for (auto & c : text) { if (c == 'B') break; c = toupper(c); }": ["/ns/{text}"],
    "std::transform(text.begin(), text.end(), text.begin(), ::tolower);": ["/ns/abc"],
    "std::transform(text.begin(), text.end(), text.begin(),"
    " [](unsigned char c) { return std::toupper(c); });": ["/ns/ABC"],
    "std::transform(who().begin(), who().end(), text.begin(), ::tolower);": ["/ns/{text}"],
    "text = boost::to_upper_copy(text);": ["/ns/ABC"],
    "boost::algorithm::to_lower(text);": ["/ns/abc"],
    "std::vector<std::string> all = {text, text}; for (auto & one : all) one = one + '1';"
    " text = all[1];": ["/ns/aBc1"],
}


@pytest.mark.parametrize("body", LETTERS)
def test_a_text_whose_letters_are_changed_one_by_one(body):
    made = "create_publisher<std_msgs::msg::Bool>(text, 1);"
    assert names(cpp(f'std::string text = "aBc"; {body} {made}')) == LETTERS[body]


CHANGES = {
    'boost::replace_all(text, "::", "/");': ["/ns/a/b/c"],
    'text = boost::replace_all_copy(text, "::", who());': ["/ns/{text}"],
    'boost::replace_all(text, who(), "/");': ["/ns/{text}"],
    'text = "/" + text + " "; boost::trim(text);': ["/a::b::c"],
    'if (boost::starts_with(text, "a::")) text = "found";': ["/ns/found"],
    'if (!boost::algorithm::ends_with(text, "d")) text = "found";': ["/ns/found"],
    'if (boost::contains(text, "::c")) text = "found";': ["/ns/found"],
}


@pytest.mark.parametrize("body", CHANGES)
def test_a_text_that_boost_changes(body):
    """boost.org: String Algorithms Library."""
    made = "create_publisher<std_msgs::msg::Bool>(text, 1);"
    assert names(cpp(f'std::string text = "a::b::c"; {body} {made}')) == CHANGES[body]
