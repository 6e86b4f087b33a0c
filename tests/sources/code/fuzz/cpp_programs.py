"""Random programs in C++ whose endpoints are known, since they are written around them.

A program is a row of pieces. Each piece makes endpoints by one construct of the language, and
knows their names and kinds; what it writes but never runs has names of its own.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from random import Random
from textwrap import indent

MAX_PIECES = 8
MAX_WRAPPERS = 3


@dataclass(frozen=True)
class Library:
    """How a client library is written: its types and calls, `{name}` stands for the name."""

    ros: int
    handle: str
    """The type of a parameter or variable through which endpoints are made."""
    member: str
    """The type of a member that holds it."""
    types: dict[str, str]
    calls: dict[str, str]
    messages: dict[str, str]
    timer: str
    head: str
    main: str


ROSCPP = Library(
    ros=1,
    handle="ros::NodeHandle &",
    member="ros::NodeHandle",
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
    timer="auto timer{id} = {h}.createWallTimer(ros::WallDuration(0.05), {callback}, true);\n"
    "kept.push_back(std::make_shared<ros::WallTimer>(timer{id}));",
    head="""#include <ros/ros.h>
#include <roscpp/Empty.h>
#include <std_msgs/Bool.h>
#include <std_msgs/Int32.h>
{includes}
void on_message(const std_msgs::Int32::ConstPtr &) {{}}
bool on_request(roscpp::Empty::Request &, roscpp::Empty::Response &) {{ return true; }}
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
    handle="rclcpp::Node *",
    member="rclcpp::Node *",
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
    timer="auto timer{id} = {h}->create_wall_timer(std::chrono::milliseconds(50), {callback});\n"
    "kept.push_back(timer{id});",
    head="""#include <rclcpp/rclcpp.hpp>
#include <rclcpp_action/rclcpp_action.hpp>
#include <std_msgs/msg/bool.hpp>
#include <std_msgs/msg/int32.hpp>
#include <std_srvs/srv/empty.hpp>
#include <test_msgs/action/fibonacci.hpp>
{includes}
void on_message(std_msgs::msg::Int32::SharedPtr) {{}}
void on_request(
  std::shared_ptr<std_srvs::srv::Empty::Request>, std::shared_ptr<std_srvs::srv::Empty::Response>) {{}}
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
_INCLUDES = (
    *("algorithm", "array", "cstring", "deque", "functional", "future", "iterator", "list", "map"),
    *(
        "memory",
        "mutex",
        "numeric",
        "optional",
        "queue",
        "ranges",
        "set",
        "stack",
        "sstream",
        "stdexcept",
        "string",
        "string_view",
    ),
    *("thread", "tuple", "type_traits", "unordered_map", "utility", "variant", "vector", "chrono"),
)
_KEEP = """static std::vector<std::shared_ptr<void>> kept;
template <class T> T keep(T made) {
  kept.push_back(std::make_shared<T>(made));
  return made;
}
"""


@dataclass(frozen=True)
class Endpoint:
    """A kind of endpoint: its type in C++, and the expression that makes one of a name."""

    kind: str
    type: str
    call: str

    def make(self, name: str, handle: str = "h") -> str:
        """Return the expression; `name` is an expression too."""
        return self.call.format(h=handle, name=name)

    def literal(self, name: str) -> str:
        """Return the expression for a name that is written out."""
        return self.make(f'"{name}"')

    def numbered(self, prefix: str, number: str) -> str:
        """Return the expression for a name that ends with a number, which is an expression."""
        return self.make(f'"{prefix}" + std::to_string({number})')


@dataclass
class Writer:
    """Writes one piece: `top` stands in front of the program, `body` in its middle."""

    random: Random
    library: Library
    id: int
    top: list[str] = field(default_factory=list)
    body: list[str] = field(default_factory=list)
    expected: dict[tuple[str, str], str] = field(default_factory=dict)
    _count: int = 0

    @property
    def handle(self) -> str:
        """The type of the handle as a parameter."""
        return self.library.handle

    def endpoint(self, kind: str = "") -> Endpoint:
        """Return a kind of endpoint, a random one unless it is named."""
        kind = kind or self.random.choice(list(self.library.calls))
        call = f"keep({self.library.calls[kind]})"
        return Endpoint(kind, self.library.types[kind], call)

    def unused(self, prefix: str = "x") -> str:
        """Return a name that nothing else in the program has."""
        self._count += 1
        return f"{prefix}{self.id}_{self._count}"

    def expect(self, endpoint: Endpoint, name: str) -> None:
        """Note that the program has an endpoint."""
        self.expected[endpoint.kind, f"/{name}"] = self.library.messages[endpoint.kind]

    def dead(self, endpoint: Endpoint) -> str:
        """Return what makes an endpoint that the program never has."""
        return endpoint.literal(f"dead{self.id}")

    def names(self, endpoint: Endpoint, count: int) -> list[str]:
        """Return names of endpoints that the program has."""
        found = [self.unused("t") for _ in range(count)]
        for name in found:
            self.expect(endpoint, name)
        return found

    def text(self, name: str) -> str:
        """Return an expression that gives a name, written in one of many ways."""
        return self.random.choice(_SPELLINGS)(self, name)

    def quoted(self, names: list[str]) -> str:
        """Return names as a row of literals."""
        return ", ".join(f'"{name}"' for name in names)


def _split(name: str) -> tuple[str, str]:
    return name[: len(name) // 2], name[len(name) // 2 :]


def _literal(_: Writer, name: str) -> str:
    return f'"{name}"'


def _sum(_: Writer, name: str) -> str:
    left, right = _split(name)
    return f'std::string("{left}") + "{right}"'


def _adjacent(_: Writer, name: str) -> str:
    left, right = _split(name)
    return f'"{left}" "{right}"'


def _braced(_: Writer, name: str) -> str:
    return f'std::string{{"{name}"}}'


def _constant(writer: Writer, name: str) -> str:
    known = writer.unused("K")
    forms = ('static const char * const {} = "{}";', 'const std::string {} = "{}";')
    forms += ('constexpr auto {} = "{}";', 'constexpr const char {}[] = "{}";', '#define {} "{}"')
    writer.top.append(writer.random.choice(forms).format(known, name))
    return known


def _function(writer: Writer, name: str) -> str:
    known = writer.unused("name")
    left, right = _split(name)
    writer.top.append(f'std::string {known}(std::string s = "{left}") {{ return s + "{right}"; }}')
    return f"{known}()"


def _number(_: Writer, name: str) -> str:
    head, _, tail = name.rpartition("_")
    return f'"{head}_" + std::to_string({tail})'


def _ternary(writer: Writer, name: str) -> str:
    return f'({writer.id} > -1 ? "{name}" : "dead_{name}")'


def _enumerator(writer: Writer, name: str) -> str:
    kind, (head, _, tail) = writer.unused("E"), name.rpartition("_")
    writer.top.append(f"enum class {kind} {{ A = {tail}, B }};")
    return f'"{head}_" + std::to_string(static_cast<int>({kind}::A))'


def _stream(_: Writer, name: str) -> str:
    left, right = _split(name)
    return f'[] {{ std::ostringstream s; s << "{left}" << "{right}"; return s.str(); }}()'


_SPELLINGS: tuple[Callable[[Writer, str], str], ...] = (
    *(_literal, _sum, _adjacent, _braced, _constant, _function, _number, _ternary, _enumerator),
    _stream,
)


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


Construct = Callable[[Writer], None]


def write_program(
    library: Library,
    random: Random,
    constructs: list[Construct],
    wrappers: Sequence[Construct] = (),
) -> Program:
    """Return a program of these constructs, in this order, each within some of the wrappers."""
    writers = [Writer(random, library, at) for at in range(len(constructs))]
    for writer, construct in zip(writers, constructs, strict=True):
        construct(writer)
        for wrap in random.choices(wrappers, k=random.randint(0, MAX_WRAPPERS)) if wrappers else ():
            wrap(writer)
    includes = "\n".join(f"#include <{name}>" for name in _INCLUDES)
    text = library.head.format(includes=includes) + _KEEP
    lines: list[set[int]] = [set() for _ in writers]
    text = _add(text, [writer.top for writer in writers], lines)
    before, after = library.main.format(body="\0").split("\0")
    text = _add(text + before, [[indent("\n".join(w.body), "  ")] for w in writers], lines) + after
    pieces = zip(constructs, lines, writers, strict=True)
    found = (Piece(made.__name__, frozenset(at), writer.expected) for made, at, writer in pieces)
    return Program(library, text, tuple(found))


def _add(text: str, blocks: list[list[str]], lines: list[set[int]]) -> str:
    """Return the text with blocks behind it, and note the lines that each has."""
    for block, at in zip(blocks, lines, strict=True):
        first = text.count("\n") + 1
        text += "".join(f"{part}\n" for part in block)
        at.update(range(first, text.count("\n") + 1))
    return text
