"""An app with an action, /act: servers, clients and what they wrote, with and without a guard."""

import json
import os
import signal
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial

from compiler import compiled
from driven_base import start_guard
from harness import LIMIT_S, NODES, ROS_PYTHON, named, wait_for
from plans import grcn, plan_of

from rtron.vocabulary import SECOND, Domain, Flow, StreamKind

ACT = "/act"
GUARD = "/rtron/grcn_act"
GOAL_TYPE = "actionlib/TestActionGoal"
SERVER = "/action_server"
NEVER = 1_000_000_000
FOREIGN = 7
PENDING, ACTIVE, PREEMPTED, SUCCEEDED, ABORTED, REJECTED = range(6)
RECALLED = 8
ASKED, ANSWERED = ("goal", "cancel"), ("status", "feedback", "result")


@dataclass(frozen=True)
class Programs:
    """The commands that start an action's ends, by language."""

    server: dict
    client: dict


def compile_actions(folder):
    """Compile the C++ ends against libactionlib, both at once; return the programs."""
    names = ("action_server", "action_client")
    with ThreadPoolExecutor() as both:
        programs = both.map(lambda name: compiled(folder, name, "actionlib", "roscpp"), names)
    built = dict(zip(names, programs, strict=True))
    python = {name: [ROS_PYTHON, NODES / f"{name}.py"] for name in built}
    return Programs(
        server={"cpp": [built["action_server"]], "py": [*python["action_server"], "simple"]},
        client={"cpp": [built["action_client"]], "py": python["action_client"]},
    )


def action_plan(policy, publishers=("/client",), **settings):
    """Return a plan that guards /act; the first publisher has the highest priority."""
    flows = tuple(
        Flow(name=f"flow{n}", publisher=publisher, priority=len(publishers) - n)
        for n, publisher in enumerate(publishers, 1)
    )
    defaults = {
        "type": GOAL_TYPE,
        "domain": Domain.PLANNING,
        "kind": StreamKind.ACTION,
        "policy": policy,
        "flows": flows,
        "max_age": 60 * SECOND,
        "queue_size": 1000,
    }
    return plan_of(grcn(f"{ACT}/goal", (), [SERVER], **defaults | settings | {"id": "grcn_act"}))


def client_names(flow):
    """Return the remaps of a flow's client, as the guarded launch writes them."""
    asked = [f"{ACT}/{part}:=/rtron{ACT}/{part}/{flow}" for part in ASKED]
    return [*asked, *(f"{ACT}/{part}:=/rtron{ACT}/{part}/out" for part in ANSWERED)]


def server_names():
    """Return the remaps of the server."""
    asked = [f"{ACT}/{part}:=/rtron{ACT}/{part}/out" for part in ASKED]
    return [*asked, *(f"{ACT}/{part}:=/rtron{ACT}/{part}/server" for part in ANSWERED)]


class Written:
    """The whole lines of a file that another process appends to."""

    def __init__(self, path):
        self.path = path

    def lines(self):
        text = self.path.read_text() if self.path.exists() else ""
        return text[: text.rfind("\n") + 1].splitlines()


@dataclass(frozen=True)
class Line:
    """What happened at a steady time in ns, and its words."""

    time: int
    what: str
    words: tuple


class Events(Written):
    """What a client or a server wrote."""

    def all(self, *what):
        parted = [line.split(" ") for line in self.lines()]
        lines = [Line(int(time), word, tuple(words)) for time, word, *words in parted]
        return [line for line in lines if line.what in what or not what]

    def of(self, *what):
        """Return the words of events, in order."""
        return [line.words for line in self.all(*what)]

    def wait_for(self, what, count=1, limit_s=LIMIT_S):
        wait_for(lambda: len(self.all(what)) >= count, limit_s, f"{count} {what} in {self.path}")
        return self.all(what)


class Server(Events):
    """What a server did."""

    def executed(self, value=None):
        """Return how often each goal was started, by its id; those of a value, or all."""
        started = self.of("started")
        return Counter(goal for goal, number in started if value in (None, int(number)))


class Client(Events):
    """A client that does what it is told; its goals count from 1.

    Not each `hears_all` feedback: actionlib's simple clients hear none before they know their own
    goal, those in C++ keep only the last.
    """

    def __init__(self, path, process, name, *, hears_all=False):
        super().__init__(path)
        self.process, self.name, self.hears_all = process, name, hears_all
        self._commands = path.with_suffix(".commands")

    def tell(self, *commands):
        with self._commands.open("a") as file:
            file.write("".join(f"{command}\n" for command in commands))

    def send(self, *values):
        self.tell(*(f"goal {value}" for value in values))

    def done(self, count, limit_s=LIMIT_S):
        """Wait until so many goals are answered; return their statuses by number."""
        self.wait_for("done", count, limit_s)
        return {int(number): status for number, status, *_ in self.of("done")}

    def results(self):
        """Return how many results came for each goal, by its id."""
        return Counter(words[0] for words in self.of("result"))

    def text(self, number):
        """Return the text that a goal was answered with."""
        return next(" ".join(w[3:]) for w in self.of("done") if int(w[0]) == number)

    def goes_on(self, steps=10):
        """Wait until the goal in progress has made further steps, each of which sees a cancel."""
        self.wait_for("feedback", len(self.of("feedback")) + steps)
        assert not self.of("done")

    def wait_for_state(self, number, state):
        """Wait until a goal has been in a state of actionlib's client."""
        reached = (str(number), state)
        wait_for(lambda: reached in self.of("state"), what=f"{state} of goal {number}")

    def known_at(self):
        """Return when the client first heard of each goal, by its number (steady ns)."""
        states = ((int(line.words[0]), line.time) for line in reversed(self.all("state")))
        return dict(states)


class Raw(Written):
    """A client that speaks by hand."""

    def __init__(self, path, process):
        super().__init__(path)
        self.process = process
        self._commands = path.with_suffix(".commands")

    def tell(self, *commands):
        with self._commands.open("a") as file:
            file.write("".join(json.dumps(command) + "\n" for command in commands))

    def rows(self, what):
        rows = map(json.loads, self.lines())
        return [row for row in rows if row["what"] == what]

    def wait_for_result(self, count=1):
        wait_for(lambda: len(self.rows("result")) >= count, what=f"{count} results")
        return self.rows("result")


class Act:
    """The ends of /act on a master; `guarded` wires them as the guarded launch does."""

    def __init__(self, ros1, programs, plan=None):
        self.ros1, self._programs = ros1, programs
        self.guarded = plan is not None
        self.guard = start_guard(ros1, plan, GUARD) if plan else None
        self._clients = 0

    def server(self, language="py", kind=None):
        """Start a server; return what it does."""
        written = Server(self.ros1.folder / "server.txt")
        command = self._programs.server[language]
        before = len(written.all("starting"))
        words = [*command[:2], written.path, *command[2:]]
        if kind:
            words[-1] = kind
        process = self.ros1.spawn(*words, *named(SERVER), *self._server_names())
        written.process = process
        written.wait_for("starting", before + 1)
        return written

    def client(self, language="py", kind="many", name="/client", flow="flow1"):
        """Start a client; it waits for the server."""
        path = self._path(name)
        client = Client(path, None, name, hears_all=(language, kind) == ("py", "many"))
        client.tell()
        words = (*self._programs.client[language], path, path.with_suffix(".commands"), kind)
        client.process = self.ros1.spawn(*words, *named(name), *self._client_names(flow))
        return client

    def clients(self):
        """Start a client of every kind in each language, as flow1 to flow4."""
        kinds = [(language, kind) for language in ("py", "cpp") for kind in ("simple", "many")]
        return [
            self.client(*ends, name=f"/client{n}", flow=f"flow{n}")
            for n, ends in enumerate(kinds, 1)
        ]

    def raw(self, name="/client", flow="flow1"):
        """Start a client that speaks by hand; without a flow it is a stranger."""
        path = self._path(name)
        raw = Raw(path, None)
        raw.tell()
        names = self._client_names(flow) if flow else ()
        words = (path, path.with_suffix(".commands"))
        raw.process = self.ros1.node("raw_action.py", name, *words, *names)
        return raw

    def flood(self, rate=1000, flow=None):
        """Start the stranger."""
        names = self._client_names(flow) if flow else ()
        return self.ros1.node("goal_flooder.py", "/stranger", str(rate), *names)

    def giant_server(self, count, state):
        """Start a server that tells of so many goals of others in a state."""
        words = (str(count), str(state), *self._server_names())
        return self.ros1.node("many_goals_server.py", SERVER, *words)

    def guard_pid(self):
        """Return the process of the guard's node; None while it does not answer."""
        uri = self.ros1.uri_of(GUARD)
        return uri and self.ros1.ask(uri, "getPid")

    def kill_guard(self):
        """End the guard without a word, and wait until its supervisor has started another."""
        killed = self.guard_pid()
        os.kill(killed, signal.SIGKILL)
        wait_for(lambda: self.guard_pid() not in (killed, None), what="the guard's return")

    @contextmanager
    def without_guard(self):
        """Keep the guard away: it is killed, and its supervisor, if any, is stopped meanwhile."""
        killed = self.guard_pid()
        self.guard.tell(signal.SIGSTOP)
        os.kill(killed, signal.SIGKILL)
        yield
        self.guard.tell(signal.SIGCONT)
        wait_for(lambda: self.guard_pid() not in (killed, None), what="the guard's return")

    def wait_for_ends(self, *clients):
        """Wait until clients and the server are connected to the guard again, both ways."""
        for client, flow in clients:
            self._wait_for_topics(client.name, GUARD, flow, ASKED)
            self._wait_for_topics(GUARD, client.name, "out", ANSWERED)
        self._wait_for_topics(GUARD, SERVER, "out", ASKED)
        self._wait_for_topics(SERVER, GUARD, "server", ANSWERED)

    def _wait_for_topics(self, publisher, subscriber, end, parts):
        for part in parts:
            topic = f"/rtron{ACT}/{part}/{end}"
            connected = partial(self.ros1.connected, publisher, subscriber, topic)
            wait_for(connected, what=f"{topic} from {publisher} to {subscriber}")

    def _path(self, name):
        self._clients += 1
        return self.ros1.folder / f"{self._clients}{name.replace('/', '_')}.txt"

    def _server_names(self):
        return server_names() if self.guarded else ()

    def _client_names(self, flow):
        return client_names(flow) if self.guarded else ()


def assert_served(served, clients):
    """Assert that goals, feedback, results and cancels of each client are as actionlib has them."""
    for client in clients:
        (connected,) = client.wait_for("connected")
        assert connected.time > served.all("starting")[0].time
        client.tell("goal 30", "wait 0", "goal -5", "wait 0", "goal 60000")
        client.wait_for("done", 2)
        client.wait_for("feedback", len(client.of("feedback")) + 5)
        client.tell("cancel 3")
        assert client.done(3) == {1: "SUCCEEDED", 2: "ABORTED", 3: "PREEMPTED"}
        assert [words[2] for words in client.of("done")] == ["30", "-5", "60000"]
        assert [client.text(n) for n in (1, 2, 3)] == ["done", "aborted", "cancelled"]
        steps = [int(step) for number, step in client.of("feedback") if number == "3"]
        assert steps == sorted(set(steps))
        assert steps[:3] == [0, 1, 2] or not client.hears_all
        client.wait_for("result", 3)
        assert set(client.results().values()) == {1}
    assert set(served.executed().values()) == {1}
    assert set(served.executed()) == {goal for client in clients for goal in client.results()}
