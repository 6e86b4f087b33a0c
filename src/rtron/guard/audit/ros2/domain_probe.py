"""What a stranger sees of a ROS 2 domain: a process of its own, without a certificate.

It can be alone in a network of its own, beside the machine's /dev/shm: Fast DDS takes all networks
that have nothing but `lo` for one host, on which it speaks through shared memory (Fast-DDS issues
6524, 5313).
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from dataclasses import dataclass
from typing import TYPE_CHECKING

from rtron.errors import SourceError
from rtron.guard.audit.ros2.observed_graph import GraphReader
from rtron.guard.cell.init import raise_loopback
from rtron.vocabulary import PRIVATE_ROOT
from rtron.wire.ros2.discovery_tuning import configure_cyclone, configure_fast_dds

if TYPE_CHECKING:
    from collections.abc import Iterable, Mapping, Sequence

PROBE_NODE = f"{PRIVATE_ROOT}/probe"
_LOOK_S = 5.0
_LIMIT_S = 30.0
_PROFILES = ("FASTDDS_DEFAULT_PROFILES_FILE", "FASTRTPS_DEFAULT_PROFILES_FILE")
_HOST_NETWORK, _OWN_NETWORK = "host", "own"


@dataclass(frozen=True, slots=True)
class ProbedEndpoint:
    """An endpoint that a stranger sees; `node` is "" where the domain names none."""

    topic: str
    node: str
    gid: bytes


@dataclass(frozen=True, slots=True)
class ProbedDomain:
    """What a stranger sees of a domain."""

    nodes: tuple[str, ...]
    endpoints: tuple[ProbedEndpoint, ...]


def probe_domain(domain: int, topics: Iterable[str]) -> ProbedDomain:
    """Return what a stranger sees who has no certificate."""
    environ = {name: value for name, value in os.environ.items() if not _is_security(name)}
    return _run_probe((), environ, (str(domain), _HOST_NETWORK, *topics))


def probe_shared_memory(domain: int, topics: Iterable[str]) -> ProbedDomain:
    """Return what a stranger sees by the shared memory of Fast DDS alone; only root can do that.

    SourceError if it cannot be tried.
    """
    environ = {name: value for name, value in os.environ.items() if name not in _PROFILES}
    shared = {"FASTDDS_BUILTIN_TRANSPORTS": "SHM", "ROS_AUTOMATIC_DISCOVERY_RANGE": "SUBNET"}
    words = (str(domain), _OWN_NETWORK, *topics)
    return _run_probe(("unshare", "--net", "--"), environ | shared, words)


def _is_security(name: str) -> bool:
    return name.startswith("ROS_SECURITY_")


def _run_probe(
    prefix: Sequence[str], environ: Mapping[str, str], words: Sequence[str]
) -> ProbedDomain:
    command = [*prefix, sys.executable, "-m", "rtron.guard.audit.ros2.domain_probe", *words]
    ran = subprocess.run(  # noqa: S603 - our own program
        command,
        env={**environ, "PYTHONPATH": os.pathsep.join(filter(None, sys.path))},
        capture_output=True,
        check=False,
        text=True,
        timeout=_LIMIT_S,
    )
    if ran.returncode:
        last_line = (ran.stderr.strip().splitlines() or ["it wrote nothing"])[-1]
        raise SourceError(f"the probe of a stranger failed: {last_line}")
    found = json.loads(ran.stdout)
    endpoints = (
        ProbedEndpoint(topic, node, bytes.fromhex(gid)) for topic, node, gid in found["endpoints"]
    )
    return ProbedDomain(tuple(found["nodes"]), tuple(endpoints))


def main(domain: str, network: str, *topics: str) -> None:
    """Look for some seconds, and print what is seen as JSON."""
    from rtron.wire.ros2.session import Ros2Session, rmw_identifier  # noqa: PLC0415

    if network == _OWN_NETWORK:
        raise_loopback()
    configure_fast_dds(rmw_identifier(), shares_memory=True)
    configure_cyclone()
    session = Ros2Session(int(domain))
    reader = GraphReader(session.node(PROBE_NODE))
    time.sleep(_LOOK_S)
    nodes = sorted(set(reader.nodes()) - {PROBE_NODE})
    endpoints = [(each.topic, each.node, each.gid.hex()) for each in reader.endpoints(topics)]
    session.close()
    sys.stdout.write(json.dumps({"nodes": nodes, "endpoints": endpoints}))


if __name__ == "__main__":
    main(*sys.argv[1:])
