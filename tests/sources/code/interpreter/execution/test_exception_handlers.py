"""A handler is reached only if something that its `try` runs may throw."""

import pytest
from ros2_runs import cpp, names, python, settings

WHY = "only an exception handler declares it, and whether that is reached is not known"
SURE_CPP = {
    "declared": """declare_parameter("topic", "own");
        try { create_publisher<std_msgs::msg::Bool>(get_parameter("topic").as_string(), 1); }""",
    "declared there": """try {
        auto topic = declare_parameter<std::string>("topic", "own");
        RCLCPP_INFO(get_logger(), "%s", topic.c_str());
        create_publisher<std_msgs::msg::Bool>(topic, 1); }""",
    "an inner handler takes all": """try {
        try { who_knows(); } catch (...) {}
        create_publisher<std_msgs::msg::Bool>("own", 1); }""",
    "a function that throws nothing": """auto twice = [](int count) { return 2 * count; };
        try { create_publisher<std_msgs::msg::Bool>("own", twice(4)); }""",
}
DOUBTFUL_CPP = {
    "a call of somebody else's": "who_knows();",
    "a parameter that is not declared": 'get_parameter("other").as_string();',
    "a parameter of another type": 'auto n = get_parameter("topic").as_int();',
    "one declared once more": 'declare_parameter("topic", "again");',
    "one that the launch gives another type": 'declare_parameter("number", 3);',
    "a condition that is not known": "if (who()) { throw std::runtime_error(name); }",
    "an index of what is not known": "config[name] ;",
    "a function that may throw": "auto f = []() { who_knows(); }; f();",
    "an inner handler of something else": "try { who_knows(); } catch (const Mine & e) {}",
    "a type of somebody else's": "Device device(1);",
    "a pointer or a future": "pending.get();",
    "a name that is none": 'create_publisher<std_msgs::msg::Bool>("a b", 1);',
}
CAUGHT = """ catch (const std::exception & e) {
    create_publisher<std_msgs::msg::Bool>("fallback", 1); }"""


@pytest.mark.parametrize("body", SURE_CPP.values(), ids=SURE_CPP)
def test_cpp_handler_of_what_throws_nothing_is_not_reached(body):
    found = cpp(body + CAUGHT)
    assert names(found) == ["/ns/own"]
    assert not [note for note in found.unresolved if note.why == WHY]


@pytest.mark.parametrize("body", DOUBTFUL_CPP.values(), ids=DOUBTFUL_CPP)
def test_cpp_handler_of_what_may_throw_is_possible_and_noted(body):
    top = 'declare_parameter("topic", "own"); try { '
    found = cpp(top + body + " }" + CAUGHT, settings=settings(number="text"))
    assert "/ns/fallback" in names(found)
    (note,) = [note for note in found.unresolved if note.why == WHY]
    assert note.what == "publish /ns/fallback"


def test_cpp_what_a_launch_leaves_open_may_throw():
    body = SURE_CPP["declared"] + CAUGHT
    assert "/ns/fallback" in names(cpp(body, parameters_complete=False))
    assert names(cpp(body, settings=settings(topic="given"))) == ["/ns/given"]
    assert "/ns/fallback" in names(cpp(body, settings=settings(topic=5)))


def test_what_is_declared_elsewhere_too_is_certain():
    body = "try { who_knows(); }" + CAUGHT + 'create_publisher<std_msgs::msg::Bool>("fallback", 1);'
    found = cpp(body)
    assert names(found) == ["/ns/fallback"]
    assert not [note for note in found.unresolved if note.why == WHY]


def test_what_is_certainly_thrown_is_certainly_caught():
    found = cpp('try { throw std::runtime_error("no"); }' + CAUGHT)
    assert names(found) == ["/ns/fallback"]
    assert not [note for note in found.unresolved if note.why == WHY]


SURE_PYTHON = {
    "declared": """self.declare_parameter('topic', 'own')
try:
    self.create_publisher(Bool, self.get_parameter('topic').value, 1)
""",
    "declared there": """try:
    self.declare_parameter('topic', 'own')
    topic = self.get_parameter('topic').get_parameter_value().string_value
    self.get_logger().info(f'it is {topic}')
    self.create_publisher(Bool, topic, 1)
""",
    "an inner handler takes all": """try:
    try:
        who_knows()
    except Exception:
        pass
    self.create_publisher(Bool, 'own', 1)
""",
    "a method that throws nothing": """try:
    self.create_publisher(Bool, self.named(), 1)
""",
}
DOUBTFUL_PYTHON = {
    "a call of somebody else's": "who_knows()",
    "a parameter that is not declared": "self.get_parameter('other').value",
    "one that the launch gives another type": "self.declare_parameter('number', 3)",
    "an import": "import somewhere",
    "a member that is not there": "self.missing",
    "a key that is not there": "{'a': 1}['b']",
    "a division by zero": "1 / 0",
    "a text and a number": "'a' + 1",
    "a parameter of another type": "self.get_parameter('topic').value + 1",
    "a loop over what is not known": "for item in self.get_parameter('topic').value: pass",
    "an assertion": "assert self.who_knows",
    "a function that may throw": "(lambda: who_knows())()",
    "taken apart": "a, b = self.get_parameter('topic').value",
}
EXCEPT = """except Exception as error:
    self.create_publisher(Bool, 'fallback', 1)
"""
NAMED = "def named(self):\n    return 'own'"


@pytest.mark.parametrize("body", SURE_PYTHON.values(), ids=SURE_PYTHON)
def test_python_handler_of_what_throws_nothing_is_not_reached(body):
    found = python(body + EXCEPT, members=NAMED)
    assert names(found) == ["/ns/own"]
    assert not [note for note in found.unresolved if note.why == WHY]


@pytest.mark.parametrize("body", DOUBTFUL_PYTHON.values(), ids=DOUBTFUL_PYTHON)
def test_python_handler_of_what_may_throw_is_possible_and_noted(body):
    top = "self.declare_parameter('topic', 'own')\ntry:\n    "
    found = python(top + body + "\n" + EXCEPT, settings=settings(number="text"))
    assert "/ns/fallback" in names(found)
    (note,) = [note for note in found.unresolved if note.why == WHY]
    assert note.what == "publish /ns/fallback"


FLAG = """bool fixed = false;
    try {{ {} fixed = true; }} catch (const std::exception & e) {{ {} }}
    if (!fixed) {{ create_publisher<std_msgs::msg::Bool>("open", 1); }}"""


@pytest.mark.parametrize(
    ("body", "caught", "expected"),
    [
        ("who_knows();", "", ["/ns/open"]),
        ("", "", []),
        ("who_knows();", "return;", []),
        ("who_knows();", "fixed = true;", []),
    ],
)
def test_behind_a_handler_a_flag_may_be_as_it_was_before_the_try(body, caught, expected):
    assert names(cpp(FLAG.format(body, caught))) == expected


def test_python_names_may_be_as_they_were_before_the_try():
    body = """topic = 'own'
try:
    topic = 'other'
    who_knows()
except ValueError:
    pass
self.create_publisher(Bool, topic, 1)
"""
    assert names(python(body)) == ["/ns/other", "/ns/own"]
