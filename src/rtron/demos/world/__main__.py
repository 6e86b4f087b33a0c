"""`python -m rtron.demos.world SOCKET --speed X`: the simulated world of the case studies.

It serves the device protocol on a Unix socket until SIGINT or SIGTERM. The key of its owner is in
the environment variable DEMO_KEY.
"""

import argparse
import logging
import os
import signal
import sys
from pathlib import Path

from rtron.demos.world.server.loop import WorldServer
from rtron.demos.world.server.unix_socket import listen_on_unix_socket
from rtron.errors import RTronError, SourceError

_SLOWEST, _FASTEST = 0.25, 8.0


def _speed(text: str) -> float:
    speed = float(text)
    if not _SLOWEST <= speed <= _FASTEST:
        raise argparse.ArgumentTypeError(f"need {_SLOWEST:g} to {_FASTEST:g}")
    return speed


def _arguments() -> argparse.Namespace:
    parser = argparse.ArgumentParser(
        prog="python -m rtron.demos.world",
        description="The simulated world of the case studies; its owner's key is in DEMO_KEY.",
    )
    parser.add_argument("socket", type=Path, metavar="SOCKET", help="the Unix socket to listen on")
    parser.add_argument("--speed", type=_speed, default=1.0, help="simulated s a wall s (1)")
    return parser.parse_args()


def _serve(path: Path, speed: float) -> None:
    key = os.environ.get("DEMO_KEY")
    if not key:
        raise SourceError("DEMO_KEY is not set: it is what the world's owner shows")
    with listen_on_unix_socket(path) as listener:
        server = WorldServer(listener, speed, key)
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda _number, _frame: server.stop())
        server.run()


def main() -> int:
    """Run the world, and return the exit code."""
    logging.basicConfig(format="world: %(message)s", level=logging.WARNING)
    arguments = _arguments()
    try:
        _serve(arguments.socket, arguments.speed)
    except RTronError as error:
        sys.stderr.write(f"error: {error}\n")
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main())
