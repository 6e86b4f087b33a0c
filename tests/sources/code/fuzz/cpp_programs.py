"""Random programs in C++ whose endpoints are known, since they are written around them.

A program is a row of pieces, each of which makes endpoints by one construct of the language. The
constructs are the templates of `cpp_templates/`. A template begins with `== `, its name, and the
endpoints that its text does not spell. What is above `--` stands in front of the program, the rest
in its middle. `| ` begins a line that is one of several to choose from, `+ ` continues it; an
empty line parts two such rows.

- `@` makes a word the piece's own. `t@_1`, `t@_2` are names of endpoints that the program has,
  `dead@` one that it has not. `TEXT(t@_1)` is a name in one of the ways of `names.txt`, where NAME
  is written as it is, in two halves (LEFT, RIGHT), or as HEAD and NUMBER.
- `MAKE(x)` makes the endpoint of a name, which is an expression, with the handle `h`. TYPE is the
  type of what it makes, HANDLE the type of `h` as a parameter, MEMBER as a member.
- `BLOCK` is what stands within one of `wrappers.txt`.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import count, groupby
from pathlib import Path
from random import Random
from textwrap import indent

MAX_PIECES = 8
MAX_WRAPPERS = 3
_TEMPLATES = Path(__file__).parent / "cpp_templates"
_CONSTRUCTS = ["containers", "control_flow", "functions", "classes", "odd_places", "iteration"]


@dataclass(frozen=True)
class Library:
    """How a client library is written: its types and calls, `{name}` stands for the name."""

    ros: int
    words: dict[str, str]
    """What words of a template stand for."""
    types: dict[str, str]
    calls: dict[str, str]
    messages: dict[str, str]
    head: str
    main: str


ROSCPP = Library(
    ros=1,
    words={
        "HANDLE": "ros::NodeHandle &",
        "MEMBER": "ros::NodeHandle",
        "TICK": "const ros::WallTimerEvent &",
        "TIMER_FUNCTION": "boost::function<void(const ros::WallTimerEvent &)>",
        "START_TIMER": "auto started@ = h.createWallTimer(ros::WallDuration(0.05), timer@, true);\n"
        "kept.push_back(std::make_shared<ros::WallTimer>(started@));",
    },
    types={
        "publish": "ros::Publisher",
        "subscribe": "ros::Subscriber",
        "service": "ros::ServiceServer",
        "service_client": "ros::ServiceClient",
    },
    calls={
        "publish": "{h}.advertise<std_msgs::Bool>({name}, 1)",
        "subscribe": "{h}.subscribe({name}, 1, on_message)",
        "service": "{h}.advertiseService({name}, on_request)",
        "service_client": "{h}.serviceClient<roscpp::Empty>({name})",
    },
    messages={
        "publish": "std_msgs/Bool",
        "subscribe": "std_msgs/Int32",
        "service": "roscpp/Empty",
        "service_client": "roscpp/Empty",
    },
    head="""#include <ros/ros.h>
#include <roscpp/Empty.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Int32.h>
#include <bits/stdc++.h>
void on_message(const std_msgs::Int32::ConstPtr &) {}
bool on_request(roscpp::Empty::Request &, roscpp::Empty::Response &) { return true; }
""",
    main="""int main(int argc, char ** argv) {{
  ros::init(argc, argv, "fuzz");
  ros::NodeHandle h;
{body}
  ros::spin();
}}
""",
)

RCLCPP = Library(
    ros=2,
    words={
        "HANDLE": "rclcpp::Node *",
        "MEMBER": "rclcpp::Node *",
        "TICK": "",
        "TIMER_FUNCTION": "std::function<void()>",
        "START_TIMER": "auto started@ = h->create_wall_timer(std::chrono::seconds(1), timer@);\n"
        "kept.push_back(started@);",
    },
    types={
        "publish": "rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr",
        "subscribe": "rclcpp::Subscription<std_msgs::msg::Int32>::SharedPtr",
        "service": "rclcpp::Service<std_srvs::srv::Empty>::SharedPtr",
        "service_client": "rclcpp::Client<std_srvs::srv::Empty>::SharedPtr",
        "action_client": "rclcpp_action::Client<test_msgs::action::Fibonacci>::SharedPtr",
    },
    calls={
        "publish": "{h}->create_publisher<std_msgs::msg::Bool>({name}, 10)",
        "subscribe": "{h}->create_subscription<std_msgs::msg::Int32>({name}, 10, on_message)",
        "service": "{h}->create_service<std_srvs::srv::Empty>({name}, on_request)",
        "service_client": "{h}->create_client<std_srvs::srv::Empty>({name})",
        "action_client": "rclcpp_action::create_client<test_msgs::action::Fibonacci>({h}, {name})",
    },
    messages={
        "publish": "std_msgs/msg/Bool",
        "subscribe": "std_msgs/msg/Int32",
        "service": "std_srvs/srv/Empty",
        "service_client": "std_srvs/srv/Empty",
        "action_client": "test_msgs/action/Fibonacci",
    },
    head="""#include <rclcpp/rclcpp.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_msgs/msg/int32.hpp>
#include <std_srvs/srv/empty.hpp>
#include <test_msgs/action/fibonacci.hpp>
#include <bits/stdc++.h>
void on_message(std_msgs::msg::Int32::SharedPtr) {}
void on_request(
  std::shared_ptr<std_srvs::srv::Empty::Request>,
  std::shared_ptr<std_srvs::srv::Empty::Response>) {}
""",
    main="""class Fuzz : public rclcpp::Node {{
public:
  Fuzz() : rclcpp::Node("fuzz") {{
  rclcpp::Node * h = this;
{body}
  }}
}};
int main(int argc, char ** argv) {{
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Fuzz>());
}}
""",
)
LIBRARIES = {"roscpp": ROSCPP, "rclcpp": RCLCPP}
_KEEP = """static std::vector<std::shared_ptr<void>> kept;
template <class T> T keep(T made) {
  kept.push_back(std::make_shared<T>(made));
  return made;
}
"""


@dataclass(frozen=True)
class Construct:
    """A template: what it declares without spelling it, and its lines."""

    name: str
    endpoints: tuple[str, ...]
    top: tuple[str, ...]
    body: tuple[str, ...]

    @property
    def forms(self) -> int:
        """How many programs have each of its alternatives once."""
        return max((len(each) for each in _alternatives((*self.top, "", *self.body))), default=1)


def read_templates(*files: str) -> dict[str, Construct]:
    """Return the templates of some files by their names."""
    found = {}
    for file in files:
        for text in (_TEMPLATES / f"{file}.txt").read_text().removeprefix("== ").split("\n== "):
            head, *lines = text.splitlines()
            name, _, endpoints = head.partition(": ")
            at = lines.index("--") if "--" in lines else -1
            top, body = lines[: max(at, 0)], lines[at + 1 :]
            found[name] = Construct(name, tuple(endpoints.split()), tuple(top), tuple(body))
    return found


CONSTRUCTS = read_templates(*_CONSTRUCTS)
WRAPPERS = read_templates("wrappers")
_SPELLINGS = [*read_templates("names").values()]


def _alternatives(lines: Sequence[str]) -> list[list[str]]:
    """Return the alternatives of each row of lines that has some."""
    rows = [[*row] for some, row in groupby(lines, lambda line: line[:2] in ("| ", "+ ")) if some]
    texts = ("\n".join(row).removeprefix("| ").split("\n| ") for row in rows)
    return [[each.replace("\n+ ", "\n") for each in text] for text in texts]


@dataclass
class Writer:
    """Writes one piece: `top` stands in front of the program, `body` in its middle."""

    library: Library
    random: Random
    id: int
    form: int | None
    top: list[str] = field(default_factory=list)
    body: list[str] = field(default_factory=list)
    expected: dict[tuple[str, str], str] = field(default_factory=dict)
    _numbers: count = field(default_factory=count)

    def write(self, construct: Construct) -> None:
        """Add what a template says; a wrapper takes what there is of the body."""
        kind = self.random.choice(list(self.library.calls))
        own = f"_{self.id}_{next(self._numbers)}"
        block = indent("\n".join(self.body), "  ")
        texts = [self._chosen(lines) for lines in (construct.top, construct.body)]
        for name in (*construct.endpoints, *re.findall(r"\bt@_\d+", "\n".join(texts))):
            key = kind, f"/{name.replace('@', own)}"
            self.expected[key] = self.library.messages[kind]
        top, body = (self._filled(text, kind, own).replace("BLOCK", block) for text in texts)
        self.top += [top] if top else []
        is_wrapper = "BLOCK" in "".join(texts)
        self.body = [body] if is_wrapper else [*self.body, body]

    def _chosen(self, lines: Sequence[str]) -> str:
        """Return the lines, with one of each row of alternatives."""
        chosen = iter([self._choose(row) for row in _alternatives(lines)])
        rows = groupby(lines, lambda line: line[:2] in ("| ", "+ "))
        return "\n".join(next(chosen) if some else "\n".join(row) for some, row in rows)

    def _choose(self, row: list[str]) -> str:
        return self.random.choice(row) if self.form is None else row[self.form % len(row)]

    def _filled(self, text: str, kind: str, own: str) -> str:
        """Return a text with what its words stand for."""
        for word, meaning in {**self.library.words, "TYPE": self.library.types[kind]}.items():
            text = re.sub(rf"\b{word}\b", lambda _, meaning=meaning: meaning, text)
        text = re.sub(r"TEXT\((\S+?)\)", lambda found: self._spelled(found[1], own), text)
        return _with_calls(text, f"keep({self.library.calls[kind]})").replace("@", own)

    def _spelled(self, name: str, own: str) -> str:
        """Return an expression that gives a name, written in one of many ways."""
        name = name.replace("@", own)
        head, _, number = name.rpartition("_")
        parts = {"NAME": name, "LEFT": name[: len(name) // 2], "RIGHT": name[len(name) // 2 :]}
        parts |= {"HEAD": f"{head}_", "NUMBER": number}
        spelling = self.random.choice(_SPELLINGS)
        top, body = (
            re.sub(r"NAME|LEFT|RIGHT|HEAD|NUMBER", lambda found: parts[found[0]], text)
            for text in (self._chosen(spelling.top), self._chosen(spelling.body))
        )
        own = f"_{self.id}_{next(self._numbers)}"
        self.top += [top.replace("@", own)] if top else []
        return body.replace("@", own)


def _with_calls(text: str, call: str) -> str:
    """Fill in what MAKE(x) stands for; x has parentheses in pairs."""
    while found := re.search(r"\bMAKE\(", text):
        depth, end = 1, found.end()
        while depth:
            depth += {"(": 1, ")": -1}.get(text[end], 0)
            end += 1
        made = call.format(h="h", name=text[found.end() : end - 1])
        text = text[: found.start()] + made + text[end:]
    return text


@dataclass(frozen=True)
class Piece:
    """What one construct wrote: the lines it stands at, and the endpoints that it makes."""

    construct: str
    lines: frozenset[int]
    expected: dict[tuple[str, str], str]


@dataclass(frozen=True)
class Program:
    """A program's text and its pieces."""

    library: Library
    text: str
    pieces: tuple[Piece, ...]

    @property
    def expected(self) -> dict[tuple[str, str], str]:
        """All endpoints of the program, kind and name, with their types."""
        return {key: type for piece in self.pieces for key, type in piece.expected.items()}


def write_program(
    library: Library, random: Random, constructs: Sequence[Construct], form: int | None = None
) -> Program:
    """Return a program of these constructs, in this order, each within some of the wrappers.

    With a `form`, it has that of each row of alternatives, and no wrappers.
    """
    writers = [Writer(library, random, at, form) for at in range(len(constructs))]
    for writer, construct in zip(writers, constructs, strict=True):
        writer.write(construct)
        wrappers = random.randint(0, MAX_WRAPPERS) if form is None else 0
        for wrapper in random.choices([*WRAPPERS.values()], k=wrappers):
            writer.write(wrapper)
    text = library.head + _KEEP
    lines: list[set[int]] = [set() for _ in writers]
    text = _add(text, [writer.top for writer in writers], lines)
    before, after = library.main.format(body="\0").split("\0")
    text = _add(text + before, [[indent("\n".join(w.body), "  ")] for w in writers], lines) + after
    pieces = zip(constructs, lines, writers, strict=True)
    found = (Piece(made.name, frozenset(at), writer.expected) for made, at, writer in pieces)
    return Program(library, text, tuple(found))


def _add(text: str, blocks: list[list[str]], lines: list[set[int]]) -> str:
    """Return the text with blocks behind it, and note the lines that each has."""
    for block, at in zip(blocks, lines, strict=True):
        first = text.count("\n") + 1
        text += "".join(f"{part}\n" for part in block)
        at.update(range(first, text.count("\n") + 1))
    return text
