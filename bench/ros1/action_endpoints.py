"""The action /act of the tests (tests/ros1), with a guard and without, on masters of its own."""

import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from typing import Any

from bench.common.testbed import ROOT, Testbed

sys.path.append(str(ROOT / "tests" / "ros1"))

from action_app import Act, Client, Server, action_plan, compile_actions
from action_load import Load
from harness import Ros1

from rtron.vocabulary import PolicyName

__all__ = ["ActionEndpoints", "Load", "compile_actions", "master", "run_both_routes"]
_LIMIT_S = 60


@dataclass(frozen=True, slots=True)
class ActionEndpoints:
    """A server and a client in C++, and how long each goal took on its two ways, ns."""

    server: Server
    client: Client
    starts: list[int] = field(default_factory=list)
    results: list[int] = field(default_factory=list)

    def run(self, count: int) -> None:
        """Send goals of 1 ms one after the other, and add what they took."""
        before = len(self.client.all("done"))
        self.client.tell(*["goal 1", "wait 0"] * count)
        self.client.wait_for("done", before + count, _LIMIT_S)
        sent, done = (self._times(self.client, what, before) for what in ("sent", "done"))
        started, ended = (self._times(self.server, what, before) for what in ("started", "done"))
        self.starts.extend(_durations(sent, started))
        self.results.extend(_durations(ended, done))

    def _times(self, written: Any, what: str, before: int) -> list[int]:  # noqa: ANN401 - tests
        return [line.time for line in written.all(what)][before:]


@contextmanager
def master(testbed: Testbed, name: str) -> Iterator[Ros1]:
    """Run a master until the end of the block; its guard listens in the site's folder."""
    folder = testbed.folder / name
    folder.mkdir(mode=0o700)
    with Ros1(folder) as ros1:
        ros1.environ["XDG_RUNTIME_DIR"] = str(folder)
        yield ros1


@contextmanager
def run_both_routes(testbed: Testbed, programs: Any) -> Iterator[dict[str, ActionEndpoints]]:  # noqa: ANN401 - of tests
    """Run the ends twice until the end of the block, with nothing in between and with a guard."""
    plans = {"direct": None, "guard": action_plan(PolicyName.FIFO_QUEUE)}
    with ExitStack() as stack:
        acts = {
            name: Act(stack.enter_context(master(testbed, name)), programs, plan)
            for name, plan in plans.items()
        }
        routes = {
            name: ActionEndpoints(act.server("cpp"), act.client("cpp"))
            for name, act in acts.items()
        }
        for endpoints in routes.values():
            endpoints.client.wait_for("connected")
        yield routes


def _durations(starts: list[int], stops: list[int]) -> Iterator[int]:
    return (end - begin for begin, end in zip(starts, stops, strict=True))
