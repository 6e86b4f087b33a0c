"""A message from one roslibpy client to another: through the bridge and ROS 1, and directly.

The peer is a WebSocket server that passes frames on and does nothing else. Runs alternate.
"""

from collections.abc import Iterator
from contextlib import ExitStack

from bench.common.latency import quantile
from bench.common.testbed import ReportProgress, Testbed, python, result_of, running, wait_for_port
from figures.figure import Figure
from rtron.bridge.rights.tokens import token_hash
from rtron.demos.runtime.isolation import free_port

_RUNS, _MESSAGES = 5, 300
_PLAN = "schema: rtron.plan/1\napp: bench\nros: 1\n"
_RIGHTS = f"""schema: rtron.bridge/1
clients:
  - name: sender
    tokens: ["{token_hash("sender")}"]
    publish: [{{topic: /chat, type: std_msgs/String, rate: 1000}}]
  - name: reader
    tokens: ["{token_hash("reader")}"]
    subscribe: [{{topic: /chat, type: std_msgs/String, rate: 1000}}]
"""


def figures(testbed: Testbed, progress: ReportProgress) -> Iterator[Figure]:
    """Give median and p99 of a message's way, of all runs together."""
    found: dict[str, list[int]] = {"bridge": [], "direct": []}
    with ExitStack() as stack:
        ports = {name: free_port() for name in found}
        stack.enter_context(running(testbed, _bridge(testbed, ports["bridge"])))
        direct = python("bench.bridge.direct_server", str(ports["direct"]))
        stack.enter_context(running(testbed, direct))
        for port in ports.values():
            wait_for_port(port)
        for number in range(1, _RUNS + 1):
            for name, port in ports.items():
                progress(f"messages, {name}, run {number} of {_RUNS}")
                words = (str(port), "sender", "reader", str(_MESSAGES))
                found[name] += result_of(testbed, python("bench.bridge.round_trip", *words))
    ours, peer = sorted(found["bridge"]), sorted(found["direct"])
    for part, share in (("median", 0.5), ("p99", 0.99)):
        both = quantile(ours, share), quantile(peer, share)
        yield Figure(f"bridge.{part}", *both, "us (peer: frames passed on directly)")


def _bridge(testbed: Testbed, port: int) -> list[str]:
    plan, rights = testbed.folder / "bridge_plan.yaml", testbed.folder / "bridge.yaml"
    plan.write_text(_PLAN)
    rights.write_text(_RIGHTS)
    files = ("--plan", str(plan), "--rights", str(rights))
    return python("rtron", "bridge", *files, "--port", str(port))
