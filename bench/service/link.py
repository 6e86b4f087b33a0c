"""What the link to the security service costs the guard's messages, and how fast settings are.

Both ways carry the same load: a hop at 200 Hz, and beside it a publisher each of whose 500 messages
a second is an event. In one of them the guard is linked, and the service stores all of that. The
service, which has a machine of its own on most sites, runs only when nobody else wants to here.
"""

import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import replace
from pathlib import Path

from bench.common.latency import median, quantile, typical_p99
from bench.common.plans import SUBSCRIBER, TWIST, grcn
from bench.common.pubsub import PUBLISHER, Load, Route, interleave
from bench.common.testbed import ReportProgress, Testbed, python, running
from bench.common.workload import CHANGES, HOP_SECONDS, RUNS
from bench.ros1.noise import NODE
from bench.ros1.routes import direct
from bench.service.service_process import ServiceProcess
from figures.figure import Figure
from rtron.planning.plan_file.writer import write_plan
from rtron.vocabulary import (
    RSRCN,
    Flow,
    GuardedTopic,
    Mode,
    Plan,
    PolicyName,
    flow_topic,
    output_topic,
)

ROBOT = "bench"
NOISY = "/noisy/cmd_vel"
NOISE = 500
"""Events a second."""
_HOP = 200
_ACKNOWLEDGED_MS = 100.0
_WORSE = 1.1
_PATIENCE_S = 30.0


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give the hop's latency with the link and without, the events stored, and the settings."""
    with ServiceProcess(testbed.folder, "", "--log-level", "warning", idle=True) as service:
        token = service.create_token(ROBOT, "guard", robot=ROBOT)
        yield from _hop(testbed, progress, service, token)
        yield from _settings(testbed, progress, service, token)


def _hop(
    testbed: Testbed, progress: ReportProgress, service: ServiceProcess, token: Path
) -> Iterator[Figure]:
    routes = [
        direct(),
        _link_route("linked", service, token),
        _link_route("unlinked", service, None),
    ]
    found = interleave(testbed, routes, Load(_HOP * HOP_SECONDS, _HOP), RUNS, progress)
    for name, statistic in (("median", median), ("typical_p99", typical_p99)):
        none = statistic(found["direct"])
        ours, peer = statistic(found["linked"]) - none, statistic(found["unlinked"]) - none
        unit = "us added (peer: no link)"
        yield Figure(f"link.hop_{name}", ours, peer, unit, at_most=_WORSE * peer)
    lost = {name: sum(run.lost for run in runs) for name, runs in found.items()}
    yield Figure("link.hop_lost", lost["linked"], lost["unlinked"], "messages", at_most=0)
    stored = service.request(f"/api/v1/events?robot={ROBOT}&limit=1")["events"][0]["id"]
    expected_events = 0.8 * RUNS * HOP_SECONDS * NOISE
    yield Figure("link.events_meanwhile", stored, None, "events", at_least=expected_events)


def _settings(
    testbed: Testbed, progress: ReportProgress, service: ServiceProcess, token: Path
) -> Iterator[Figure]:
    """Give how long it takes from asking for a change until the guard's word is stored."""
    took = []
    with run_guard_with_noise(testbed, service, token):
        _wait_for(service, lambda robot: robot["connected"])
        for number in range(CHANGES):
            progress(f"settings, change {number + 1} of {CHANGES}")
            began = time.time_ns()
            nodes = {"rsrcn": {"max_vel_limit": 0.3 + number / CHANGES}}
            revision = service.change(ROBOT, nodes)["revision"]
            took.append(_answered(service, revision) - began)
    unit = "ms from the request to the guard's stored word"
    took.sort()
    yield Figure("settings.median", quantile(took, 0.5) / 1e3, None, unit)
    yield Figure("settings.p99", quantile(took, 0.99) / 1e3, None, unit, at_most=_ACKNOWLEDGED_MS)


def _answered(service: ServiceProcess, revision: int) -> int:
    """Return when the guard's word on a revision was stored, ns."""
    deadline = time.monotonic() + _PATIENCE_S
    while time.monotonic() < deadline:
        view = service.request(f"/api/v1/robots/{ROBOT}/settings")
        if view["revision"] == revision and view["outcome"] != "pending":
            if view["outcome"] != "applied":
                raise ValueError(f"revision {revision}: {view['error']}")
            return int(view["answered"])
        time.sleep(0.005)
    raise TimeoutError(f"revision {revision} is not acknowledged")


def _wait_for(service: ServiceProcess, condition: object) -> None:
    deadline = time.monotonic() + _PATIENCE_S
    while not ((robot := service.state(ROBOT)) and condition(robot)):  # type: ignore[operator]
        if time.monotonic() > deadline:
            raise TimeoutError("the guard is not connected to the service")
        time.sleep(0.02)


def _link_route(name: str, service: ServiceProcess, token: Path | None) -> Route:
    inputs = [f"{PUBLISHER}={flow_topic('/cmd_vel', 'flow1')}"]
    outputs = [output_topic("/cmd_vel")]
    return Route(
        name, inputs, outputs, lambda testbed: run_guard_with_noise(testbed, service, token)
    )


@contextmanager
def run_guard_with_noise(
    testbed: Testbed, service: ServiceProcess, token: Path | None
) -> Iterator[None]:
    """Run the guard and the noise, with the link if there is a token."""
    path = testbed.folder / "link.yaml"
    path.write_text(write_plan(_plan()), encoding="utf-8")
    command = python("rtron", "guard", "--plan", str(path), "--log-level", "warning")
    if token:
        command += ["--service", service.url, "--token-file", str(token), "--robot", ROBOT]
        command += ["--state-dir", str(testbed.folder / "state")]
    noise = python("bench.ros1.noise", flow_topic(NOISY, "vflow1"), str(NOISE))
    with ExitStack() as stack:
        stack.enter_context(running(testbed, command))
        stack.enter_context(running(testbed, noise))
        yield


def _plan() -> Plan:
    hop = grcn("/cmd_vel", [PUBLISHER])
    flows = (Flow(name="vflow1", publisher=NODE),)
    noisy = GuardedTopic(topic=NOISY, type=TWIST, flows=flows, successors=(SUBSCRIBER,))
    rsrcn = RSRCN(
        id="rsrcn",
        mode=Mode.ENFORCE,
        policy=PolicyName.CONSTRAIN,
        max_vel_limit=0.5,
        vflows=(noisy,),
    )
    return replace(Plan(app="bench"), grcn=(hop,), rsrcn=rsrcn)
