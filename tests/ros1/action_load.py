"""Many goals of three clients in random order, while a stranger floods /act."""

from collections import Counter
from random import Random

from action_app import ASKED, FOREIGN, GUARD, Act, action_plan
from harness import LIMIT_S, wait_for

from rtron.vocabulary import SECOND

CLIENTS = (("/one", "py"), ("/other", "py"), ("/third", "cpp"))
FLOOD = 1000
_LONGEST_MS = 4
_OPEN = 100
_LATE = SECOND // 4
_QUEUE_PARAMETERS = ("/actionlib_client_pub_queue_size", "/act/actionlib_client_pub_queue_size")


class Load:
    """The app with its stranger, and what became of the goals once `run` was called.

    The clients share `count` goals; the stranger has sent over FLOOD / 10 before the first of them.
    """

    def __init__(self, ros1, programs, policy, *, server, max_age, count=1000):
        for parameter in _QUEUE_PARAMETERS:
            ros1.ask(ros1.uri, "setParam", parameter, 2 * _OPEN)
        self._ros1, self._max_age = ros1, max_age
        self._counts = [(count + n) // len(CLIENTS) for n in range(len(CLIENTS))]
        publishers = [name for name, _ in CLIENTS]
        self.act = Act(ros1, programs, action_plan(policy, publishers, max_age=max_age))
        self.served = self.act.server(server)
        named = enumerate(CLIENTS, 1)
        self.clients = [
            self.act.client(lang, name=name, flow=f"flow{n}") for n, (name, lang) in named
        ]
        for client in self.clients:
            client.wait_for("connected")
        self.act.flood(2 * FLOOD)  # rospy keeps about half of it up
        wait_for(lambda: self.flooded() > FLOOD / 10, what="the stranger")
        self._done = {}

    def run(self):
        """Send all goals and wait until each is answered."""
        self._send()
        for client, count in zip(self.clients, self._counts, strict=True):
            self._done[client.name] = client.done(count, LIMIT_S)
            client.wait_for("result", count)

    def flooded(self):
        """Return how many goals and cancels of the stranger the guard has received."""
        return sum(self._ros1.received(GUARD, f"/act/{part}") for part in ASKED)

    def ends(self):
        """Return how each goal has ended, by its client and number."""
        done = self._done.items()
        return {(name, number): end for name, each in done for number, end in each.items()}

    def answered_otherwise(self):
        """Return the goals that were not answered once, or did not run once if they succeeded.

        With each is how many results came, how often its client was told, and how often it ran.
        """
        results, told = Counter(), Counter()
        for client in self.clients:
            results.update({_number_of(goal): n for goal, n in client.results().items()})
            told.update((client.name, int(words[0])) for words in client.of("done"))
        ran = Counter({_number_of(goal): n for goal, n in self.served.executed().items()})
        ends = self.ends()
        counts = {
            goal: (results[goal], told[goal], ran[goal]) for goal in {*ends, *results, *told, *ran}
        }
        return {
            goal: count
            for goal, count in counts.items()
            if count != (1, 1, ends.get(goal) == "SUCCEEDED")
        }

    def touched(self):
        """Return the goals that ended otherwise than by success or age, and the stranger's own."""
        strange = set(self.served.executed(FOREIGN))
        for client in self.clients:
            for number, end, _, *text in client.of("done"):
                old = end == "RECALLED" and text[:2] == ["too", "old:"]
                if end != "SUCCEEDED" and not old:
                    strange.add((client.name, int(number)))
        return strange

    def late(self):
        """Return the goals that were started when they had waited, as their client knew, too long.

        The client hears of its goal after the guard, the server is told by another connection: a
        goal may seem later than it is by what both take.
        """
        known = {client.name: client.known_at() for client in self.clients}
        late = set()
        for line in self.served.all("started"):
            name, number = _number_of(line.words[0])
            if line.time - known.get(name, {}).get(number, line.time) > self._max_age + _LATE:
                late.add((name, number))
        return late

    def _send(self):
        """Send goals of random length; so many of each client's are open at once."""
        random = Random(1)
        for client, count in zip(self.clients, self._counts, strict=True):
            goals = (f"goal {random.randint(1, _LONGEST_MS)}" for _ in range(count))
            client.tell(*(line for goal in goals for line in (goal, f"wait {_OPEN - 1}")))


def _number_of(goal_id):
    """Return the client and the number that actionlib writes into an id; 0 for any other id."""
    name, *number = goal_id.rsplit("-", 2)
    return (name, int(number[0])) if len(number) > 1 else (goal_id, 0)
