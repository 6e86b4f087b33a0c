"""The command lines of the processes that send and that listen, for either ROS."""

import argparse
from collections.abc import Iterable


def to_send(messages: Iterable[str], *, ros: int) -> argparse.Namespace:
    """Return what to publish, as the command line says; only ROS 1 has bursts."""
    parser = _parser(f"Publish for a benchmark on ROS {ros}.", messages, "messages in all")
    parser.add_argument("--publish", nargs="+", required=True, metavar="NODE=TOPIC")
    parser.add_argument(
        "--rate", type=int, default=200, help="messages/s in all; with ROS 1, 0: no pause"
    )
    bursts = None if ros == 1 else [1]
    parser.add_argument("--burst", type=int, default=1, choices=bursts, help="messages at a time")
    return parser.parse_args()


def to_listen(messages: Iterable[str], *, ros: int) -> argparse.Namespace:
    """Return what to subscribe, as the command line says."""
    parser = _parser(f"Receive for a benchmark on ROS {ros}.", messages, "messages to wait for")
    parser.add_argument("--subscribe", nargs="+", required=True, metavar="TOPIC")
    parser.add_argument("--node", default="/bench_sub")
    return parser.parse_args()


def _parser(description: str, messages: Iterable[str], counted: str) -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("--message", choices=messages, default="twist")
    parser.add_argument("--count", type=int, default=1000, help=counted)
    parser.add_argument("--limit", type=int, default=120, help="seconds after which to give up")
    return parser
