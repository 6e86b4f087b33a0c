"""The guard as a program that a supervisor starts."""

import logging
import signal
import socket
import sys

from rtron.guard.runner import run_guard
from rtron.guard.supervision.exit_code import complaining
from rtron.guard.supervision.guard_config import read_order, stopped_streams
from rtron.guard.supervision.programs import descriptors
from rtron.guard.supervision.shared_memory import Page
from rtron.guard.supervision.supervisor_client import Tie
from rtron.guard.supervision.supervisor_handover import BEGIN


def main(numbers: str) -> None:
    """Guard by the order, the page and the connection in the open files; end with the exit code.

    Not before the supervisor says so: a spare one waits here, ready, and ends with the supervisor.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    order_file, page_file, number = descriptors(numbers)
    life = socket.socket(fileno=number)
    order = read_order(order_file)
    logging.basicConfig(level=order.log_level, format="%(levelname)s %(message)s")
    page = Page(page_file, len(stopped_streams(order.plan)))
    if life.recv(len(BEGIN)) != BEGIN:
        return

    def guard() -> int:
        tie = Tie(order, page, life, order_file)
        return run_guard(order.plan, order.master, tie=tie, **order.options)

    sys.exit(complaining(guard))
