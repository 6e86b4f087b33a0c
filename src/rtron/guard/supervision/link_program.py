"""The link process as a program that a supervisor starts."""

import logging
import sys

from rtron.guard.link.relay import run_relay
from rtron.guard.supervision.exit_code import complaining
from rtron.guard.supervision.guard_config import read_order
from rtron.guard.supervision.programs import descriptors


def main(numbers: str) -> None:
    """Relay by the order in the open file that is named; end with the exit code."""
    (order_file,) = descriptors(numbers)
    order = read_order(order_file)
    logging.basicConfig(level=order.log_level, format="%(levelname)s link: %(message)s")

    def relay() -> int:
        run_relay(order.options["link"])
        return 0

    sys.exit(complaining(relay))
