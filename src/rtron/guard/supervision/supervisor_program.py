"""The supervisor as a program."""

import logging
import sys

from rtron.guard.core.event_loop import Loop
from rtron.guard.supervision.exit_code import complaining
from rtron.guard.supervision.guard_config import read_order
from rtron.guard.supervision.programs import descriptors
from rtron.guard.supervision.supervisor import Supervisor


def main(numbers: str, *, stand_in: bool = False) -> None:
    """Supervise by the order in the open file that is named; end with the exit code."""
    (order_file,) = descriptors(numbers)
    order = read_order(order_file)
    logging.basicConfig(level=order.log_level, format="%(levelname)s supervisor: %(message)s")
    sys.exit(complaining(lambda: Supervisor(order, order_file, Loop(), stand_in=stand_in).run()))
