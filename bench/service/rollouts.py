"""A change that is bad on 3 % of a fleet, rolled out: how many robots get it before it goes back.

The guards of the fleet speak the real link to one service. A bad one has an alarm in its next
state, up to a second after it got the change; how many it reached is counted by the guards. The bad
ones are drawn at random for each seed, first as a kind that a label tells, then as robots that
nothing distinguishes. At last a change that is good for all.
"""

import math
import random
import time
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from bench.common.testbed import ReportProgress, Testbed
from bench.common.workload import FLEETS, ROLLOUTS
from bench.service.fleet import Fleet, create_tokens, run_fleet
from bench.service.fleet_guards import blocking_plan
from bench.service.service_process import ServiceProcess
from figures.figure import Figure
from rtron.planning.plan_file.writer import write_plan

_BAD_SHARE = 0.03
_STAGES: Sequence[int | str] = (1, "10%", "100%")
_SECOND_STAGE = 0.1
"""The share of the fleet that has the change after the stage that follows the canary."""
_WAIT_S = 2.0
_CONNECT_S = 180.0
_ROLLOUT_S = 300.0
_QUIET_S = 3.0
"""So long after a roll-out no guard has an alarm any more."""
_KIND = "bad-kind"
_SETTINGS: Mapping[str, Any] = {"nodes": {"grcn_robot_cmd_0": {"policy": "Block"}}}


@dataclass(frozen=True, slots=True)
class _Result:
    """How a roll-out ended: its last state and stage, from 1; of how many robots; s."""

    state: str
    stage: int
    reached: int
    left: int
    took: float


@dataclass(frozen=True, slots=True)
class _Hall:
    """A service and its fleet."""

    service: ServiceProcess
    fleet: Fleet
    robots: Sequence[str]

    def roll_out(
        self, bad: Sequence[str], *, is_kind: bool, change: Mapping[str, Any] = _SETTINGS
    ) -> _Result:
        """Roll a change out to all robots, and wait for its end."""
        members = {"robots": list(bad) if is_kind else []}
        self.service.request(f"/api/v1/groups/{_KIND}", "PUT", members)
        self.fleet.report(bad)
        begin = time.monotonic()
        new = {
            "robots": {"app": "fleet"},
            **change,
            "reason": "it is measured",
            "stages": _STAGES,
            "wait": _WAIT_S,
        }
        id = self.service.request("/api/v1/rollouts", "POST", new)["id"]
        view = self._wait_for(id, "done", "reverted")
        took = time.monotonic() - begin
        time.sleep(_QUIET_S)
        report = self.fleet.report()
        if view["state"] == "done":
            body = {"reason": "it is measured"}
            self.service.request(f"/api/v1/rollouts/{id}/cancel", "POST", body)
            self._wait_for(id, "reverted")
            time.sleep(_QUIET_S)
        return _Result(view["state"], view["stage"] + 1, report["reached"], report["changed"], took)

    def _wait_for(self, id: int, *states: str) -> Any:  # noqa: ANN401 - JSON
        deadline = time.monotonic() + _ROLLOUT_S
        while time.monotonic() < deadline:
            view = self._view(id)
            if view["state"] in states:
                return view
            time.sleep(0.2)
        raise TimeoutError(f"roll-out {id}: {view}")

    def _view(self, id: int) -> Any:  # noqa: ANN401 - JSON
        """Return what a roll-out is at; a busy service may refuse to say it, and goes on."""
        try:
            return self.service.request(f"/api/v1/rollouts/{id}")
        except OSError as error:
            return {"state": f"not known: {error}"}


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give how many robots each roll-out reached, and what was left."""
    size = max(FLEETS)
    folder = testbed.folder / "rollouts"
    folder.mkdir()
    tokens = create_tokens(folder / "service.sqlite", size)
    limit_s = _CONNECT_S + (2 * ROLLOUTS + 1) * _ROLLOUT_S
    with (
        ServiceProcess(folder, folder / "service.sqlite", "--log-level", "warning") as service,
        run_fleet(testbed, service.port, tokens, limit_s) as fleet,
    ):
        progress(f"{size} guards connect")
        fleet.wait_connected(time.monotonic(), _CONNECT_S)
        hall = _Hall(service, fleet, list(tokens))
        yield from _bad_figures(hall, progress, is_kind=True)
        yield from _bad_figures(hall, progress, is_kind=False)
        yield from _plan_figures(hall, progress)
        progress(f"a good change on {size} robots")
        yield from _good_figures(hall)


def _bad_figures(hall: _Hall, progress: ReportProgress, *, is_kind: bool) -> Iterator[Figure]:
    size = len(hall.robots)
    name, number = f"rollouts.{'kind' if is_kind else 'alike'}", math.ceil(_BAD_SHARE * size)
    at_most = math.ceil(_SECOND_STAGE * size)
    results: list[_Result] = []
    for seed in range(1, ROLLOUTS + 1):
        progress(f"{number} of {size} robots are bad, seed {seed}")
        bad = random.Random(seed).sample(hall.robots, number)
        result = hall.roll_out(bad, is_kind=is_kind)
        results.append(result)
        unit = f"of {size} got it; {result.state} in stage {result.stage}, {result.took:.0f} s"
        yield Figure(f"{name}.seed{seed}", result.reached, None, unit, at_most=at_most)
    beyond = sum(result.reached > at_most for result in results)
    unit = f"of {len(results)} went beyond the stage after the canary"
    yield Figure(f"{name}.beyond", beyond, None, unit, at_most=0)
    left = sum(result.left for result in results)
    yield Figure(f"{name}.left", left, None, "robots that kept a bad change", at_most=0)


def _plan_figures(hall: _Hall, progress: ReportProgress) -> Iterator[Figure]:
    """Give how many robots a plan reached that is bad for a kind of them."""
    size = len(hall.robots)
    bad = random.Random(0).sample(hall.robots, math.ceil(_BAD_SHARE * size))
    progress(f"a plan that is bad on {len(bad)} of {size} robots")
    result = hall.roll_out(bad, is_kind=True, change={"plan": write_plan(blocking_plan())})
    unit = f"of {size} got it; {result.state} in stage {result.stage}, {result.took:.0f} s"
    at_most = math.ceil(_SECOND_STAGE * size)
    yield Figure("rollouts.plan", result.reached, None, unit, at_most=at_most)
    yield Figure("rollouts.plan_left", result.left, None, "robots that kept it", at_most=0)


def _good_figures(hall: _Hall) -> Iterator[Figure]:
    size, result = len(hall.robots), hall.roll_out([], is_kind=False)
    unit = f"of {size} have it; {result.state}"
    yield Figure("rollouts.good", result.left, None, unit, at_least=size)
    unit = f"s until it was done, with {len(_STAGES)} waits of {_WAIT_S:.0f} s"
    yield Figure("rollouts.good_took", result.took, None, unit)
