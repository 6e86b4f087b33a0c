"""Keeps a demo apart from what else runs here: domain, ports, environment and packages."""

import os
import socket
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from random import SystemRandom

from rtron.errors import SourceError

_DOMAINS = range(215, 232)
"""The upper ones of those that Linux leaves to ROS 2 (docs.ros.org: The ROS_DOMAIN_ID)."""
_PORTS = (20_000, 32_000)
"""Ports that are not ephemeral: Linux gives out those from 32768 on to whoever calls."""


def free_port() -> int:
    """Return a port of the loopback device at which nobody listens, and that is given to nobody.

    Who calls an ephemeral port at which nobody listens may even be connected to itself.
    """
    while True:
        port = SystemRandom().randrange(*_PORTS)
        with socket.socket() as free, suppress(OSError):
            free.bind(("127.0.0.1", port))
            return port


@contextmanager
def reserve_domain() -> Iterator[int]:
    """Give a domain id that no other demo has; SourceError if all are taken."""
    for domain in SystemRandom().sample(_DOMAINS, len(_DOMAINS)):
        with socket.socket(socket.AF_UNIX) as lock:
            try:
                lock.bind(f"\0rtron-demo-domain-{domain}")  # abstract: gone with the process
            except OSError:
                continue
            yield domain
            return
    raise SourceError("every ROS 2 domain is taken", help="end other runs of the demo")


WIDTH = 96
"""How wide commands print, in columns."""
_EXCLUDED_PREFIXES = ("ROS_", "RTRON_", "DEMO_", "XDG_", "FASTDDS_", "FASTRTPS_")


def shared_environ(folder: Path, sockets: Path) -> dict[str, str]:
    """Return the user's environment without what leads to a ROS, a DDS or a guard of the user's.

    State and logs go to `folder`, sockets to `sockets`. What lets a sourced ROS 2 be found, its
    library and Python paths, stays.
    """
    inherited = {
        name: value for name, value in os.environ.items() if not name.startswith(_EXCLUDED_PREFIXES)
    }
    return inherited | {
        "COLUMNS": str(WIDTH),
        "PYTHONPATH": _join_paths(LOGIC, *_python_path()),
        "PYTHONUNBUFFERED": "1",
        "ROS_HOME": str(folder / "ros"),
        "ROS_LOG_DIR": str(folder / "ros" / "log"),
        "XDG_CACHE_HOME": str(folder / "cache"),
        "XDG_RUNTIME_DIR": str(sockets),
        "XDG_STATE_HOME": str(folder / "state"),
    }


def ros1_environ(port: int) -> dict[str, str]:
    """Return what leads to a ROS master at a port, and to the demo's packages.

    ROS 1 runs in Debian's Python, so that no other Python's packages may get in its way.
    """
    return {
        "PYTHONPATH": str(LOGIC),
        "ROS_HOSTNAME": "127.0.0.1",
        "ROS_IP": "127.0.0.1",
        "ROS_MASTER_URI": f"http://127.0.0.1:{port}",
        "ROS_PACKAGE_PATH": _join_paths(first_party_packages(1), str(third_party_packages(1))),
    }


def ros2_environ(domain: int) -> dict[str, str]:
    """Return what leads to a ROS 2 domain on this machine alone, by the user's RMW."""
    return {
        "RMW_IMPLEMENTATION": os.environ.get("RMW_IMPLEMENTATION", "rmw_fastrtps_cpp"),
        "ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST",
        "ROS_DOMAIN_ID": str(domain),
        "ROS_LOCALHOST_ONLY": "1",
    }


def _python_path() -> list[Path]:
    """Return the user's PYTHONPATH for programs that start in another folder."""
    given = os.environ.get("PYTHONPATH", "").split(os.pathsep)
    return [Path(path).absolute() for path in given if path]


def _join_paths(*paths: Path | str) -> str:
    return os.pathsep.join(str(path) for path in paths if str(path))


APPS = Path(__file__).parents[1] / "apps"
LOGIC = APPS / "logic"
APP_NAME = "tb3_demo"
"""The app's own name, and that of the developer's own package."""
_LAUNCH = {1: "tb3_demo.launch", 2: "tb3_demo.launch.xml"}


def first_party_packages(ros: int) -> Path:
    """Return the folder of the developer's own packages."""
    return APPS / f"ros{ros}"


def third_party_packages(ros: int) -> Path:
    """Return the folder of the packages that the developer has from elsewhere."""
    return APPS / "third_party" / f"ros{ros}"


def launch_file(ros: int) -> Path:
    """Return the launch file that starts the whole app, unguarded."""
    return first_party_packages(ros) / APP_NAME / "launch" / _LAUNCH[ros]
