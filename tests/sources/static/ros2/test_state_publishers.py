"""Which latched topics the source of a node sends once or on change, in C++ and in Python."""

from dataclasses import replace
from time import process_time

import pytest
from file_tree import package

from rtron.sources.static.ros2.state_publishers import with_state_publishers
from rtron.sources.workspace import Workspace
from rtron.vocabulary import (
    Direction,
    Durability,
    Endpoint,
    Evidence,
    InteractionGraph,
    Node,
    QoS,
    Resolution,
    WiringFactKind,
)

LATCHED = QoS(durability=Durability.TRANSIENT_LOCAL)
CMAKE = "project(robot)\nadd_executable(board src/board.cpp)\n"
CPP = """#include <rclcpp/rclcpp.hpp>
class Board : public rclcpp::Node {
public:
  Board() : Node("board") {
    state_ = create_publisher<Bool>("stop_state", rclcpp::QoS(1).transient_local());
    all_ = create_service<Trigger>("all", std::bind(&Board::release, this));
    %s
  }
private:
  void tell(bool stopped) { Bool m; m.data = stopped; state_->publish(m); }
  void release() { tell(false); }
  %s
};
int main(int argc, char** argv) {
  rclcpp::init(argc, argv);
  rclcpp::spin(std::make_shared<Board>());
}
"""
PYTHON = """#!/usr/bin/env python3
class Board(Node):
    def __init__(self):
        super().__init__('board')
        self.state = self.create_publisher(Bool, 'stop_state', latched)
        self.create_service(Trigger, 'all', self.release)
        %s
    def tell(self, stopped):
        self.state.publish(Bool(data=stopped))
    def release(self):
        self.tell(False)
    %s
def main():
    rclpy.init()
    board = Board()
    while rclpy.ok():
        rclpy.spin_once(board)
"""


@pytest.fixture
def facts(tmp_path):
    """Return what is found of a node with a source, whose line 5 makes the publisher."""

    def find(files, program, change=lambda graph: graph):
        folder = package(tmp_path / "robot", files)
        (source,) = (str(folder / name) for name in files if name.endswith((".cpp", ".py")))
        node = Node(name="/board", package="robot", executable=program)
        name, place = "/stop_state", Evidence(file=source, line=5)
        sent = Endpoint(
            node="/board", topic=name, direction=Direction.PUBLISH, qos=LATCHED, evidence=(place,)
        )
        read = Endpoint(node="/pad", topic=name, direction=Direction.SUBSCRIBE, qos=QoS())
        graph = InteractionGraph(app="a", ros=2, nodes=(node,), endpoints=(sent, read))
        wiring = with_state_publishers(
            change(graph), Workspace({"robot": folder}, [tmp_path])
        ).wiring
        kinds = {WiringFactKind.STATE_PUBLISHER, WiringFactKind.SLOW_PUBLISHER}
        assert {fact.kind for fact in wiring} <= kinds
        return [(fact.subject, fact.value, fact.evidence == (place,)) for fact in wiring]

    return find


FOUND = [("/stop_state", "/board", True)]


def cpp(setup, more=""):
    return {"CMakeLists.txt": CMAKE, "src/board.cpp": CPP % (setup, more)}, "board"


def python(setup, more="pass"):
    return {"scripts/board.py": PYTHON % (setup, more)}, "board.py"


ON_CHANGE = [
    cpp("tell(true);"),
    cpp('release_ = create_service<Trigger>("release", [this](auto, auto) { tell(false); });'),
    cpp('release_ = create_service<Trigger>("release", std::bind(&Board::release, this));'),
    cpp("", "CallbackReturn on_activate(const State&) { tell(true); }"),
    cpp("for (auto wheel : wheels_) { tell(true); }"),
    python("self.tell(True)"),
    python("self.create_service(Trigger, 'release', lambda request, answer: self.tell(False))"),
    python("self.create_service(Trigger, 'release', self.release)"),
    python("self.add_on_set_parameters_callback(self.release)"),
]
AGAIN = [
    cpp("timer_ = create_wall_timer(1s, [this]() { tell(true); });"),
    cpp("timer_ = create_wall_timer(1s, std::bind(&Board::release, this));"),
    cpp('a_ = create_subscription<Empty>("a", 1, [this](Empty::SharedPtr) { release(); });'),
    cpp("thread_ = std::thread(&Board::release, this);"),
    cpp("while (rclcpp::ok()) { release(); }"),
    cpp("helper_ = std::make_shared<Helper>(state_);"),
    cpp("update_ = state_;"),
    cpp("", "void update() override { release(); }"),
    python("self.create_timer(1.0, self.release)"),
    python("self.create_timer(1.0, lambda: self.tell(True))"),
    python("self.create_timer(1.0, callback=self.release)"),
    python("self.create_subscription(Empty, 'a', self.release, 1)"),
    python("while rclpy.ok(): self.release()"),
    python("self.helper = Helper(self.state)"),
    python("self.update = self.release"),
]


@pytest.mark.parametrize(("files", "program"), ON_CHANGE)
def test_a_state_that_is_sent_once_or_on_request(facts, files, program):
    assert facts(files, program) == FOUND


@pytest.mark.parametrize(("files", "program"), AGAIN)
def test_a_state_that_something_may_send_again(facts, files, program):
    assert facts(files, program) == []


@pytest.mark.parametrize(
    "end",
    [
        {"qos": QoS()},
        {"qos": None},
        {"implicit": True},
        {"resolution": Resolution.MODEL},
        {"evidence": ()},
        {"direction": Direction.SUBSCRIBE},
    ],
)
def test_other_publishers_are_not_looked_at(facts, end):
    def change(graph):
        sent, *others = graph.endpoints
        return replace(graph, endpoints=(replace(sent, **end), *others))

    assert facts(*cpp("tell(true);"), change) == []


@pytest.mark.parametrize("qos", [LATCHED, None])
def test_nor_are_those_whose_readers_ask_for_history(facts, qos):
    def change(graph):
        sent, read = graph.endpoints
        return replace(graph, endpoints=(sent, replace(read, qos=qos)))

    assert facts(*cpp("tell(true);"), change) == []


def test_a_publisher_that_no_variable_holds_is_not_followed(facts):
    files, program = cpp("tell(true);")
    text = files["src/board.cpp"].replace("state_ = create", "states_[0] = create")
    assert facts({**files, "src/board.cpp": text}, program) == []


def test_a_publisher_that_sends_nothing_has_no_state(facts):
    files, program = cpp("tell(true);")
    text = files["src/board.cpp"].replace("state_->publish(m);", "")
    assert facts({**files, "src/board.cpp": text}, program) == []


@pytest.mark.parametrize(
    ("period", "more", "is_slow"),
    [
        ("0.5", "pass", True),
        ("0.05", "pass", False),
        ("self.period", "pass", False),
        ("0.5, self.release); self.create_timer(0.01", "pass", False),
        ("0.5", "def now(self): self.release()", False),
        ("0.5", "def now(self): self.state.publish(Bool())", False),
        ("0.5", "def now(self): self.sender = self.state", False),
    ],
)
def test_a_deadline_that_the_only_timer_does_not_hold(facts, period, more, is_slow):
    def change(graph):
        sent, _ = graph.endpoints
        return replace(graph, endpoints=(replace(sent, qos=QoS(deadline=10**8)),))

    files, program = python(f"self.create_timer({period}, self.release)", more)
    text = files["scripts/board.py"].replace("self.tell(False)", "self.state.publish(Bool())")
    text = text.replace(
        "def tell(self, stopped):\n        self.state.publish", "def tell(self, n):\n        print"
    )
    assert facts({"scripts/board.py": text}, program, change) == FOUND * is_slow


STATE = """        self.p{0} = self.create_publisher(Bool, 's{0}_state', latched)
        self.create_service(Trigger, 'go{0}', self.f{0})
"""
SENT = """    def f{0}(self, request, answer):
        self.p{0}.publish(Bool())
"""


def many_states(size):
    """Return the source of a node that latches many states, each sent by a service of its own."""
    made = "".join(STATE.format(i) for i in range(size))
    methods = "".join(SENT.format(i) for i in range(size))
    start = "class Board(Node):\n    def __init__(self):\n        super().__init__('board')\n"
    end = "def main():\n    rclpy.spin(Board())\n"
    return "#!/usr/bin/env python3\n" + start + made + methods + end


@pytest.fixture
def seconds(tmp_path):
    """Return a function from a number of states of one node to how long they take, s."""

    def measure(size):
        folder = package(tmp_path / f"robot{size}", {"scripts/board.py": many_states(size)})
        source = str(folder / "scripts/board.py")
        ends = [
            Endpoint(
                node="/board",
                topic=f"/s{i}_state",
                direction=Direction.PUBLISH,
                qos=LATCHED,
                evidence=(Evidence(file=source, line=5 + 2 * i),),
            )
            for i in range(size)
        ]
        read = [
            Endpoint(node="/pad", topic=e.topic, direction=Direction.SUBSCRIBE, qos=QoS())
            for e in ends
        ]
        graph = InteractionGraph(
            app="a",
            ros=2,
            nodes=(Node(name="/board", package=folder.name, executable="board.py"),),
            endpoints=(*ends, *read),
        )
        workspace = Workspace({folder.name: folder}, [tmp_path])
        start = process_time()
        assert len(with_state_publishers(graph, workspace).wiring) == size
        return process_time() - start

    return lambda size: min(measure(size) for _ in range(2))


def test_ten_times_the_states_of_a_node_take_ten_times_as_long(seconds):
    small, large = seconds(60), seconds(600)
    assert large < 30 * small
