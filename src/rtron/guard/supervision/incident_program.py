"""The recorder of incidents as a program that a supervisor starts."""

import signal
import socket

from rtron.guard.incidents.recorder import run_recorder
from rtron.guard.log_format import start_logging
from rtron.guard.supervision.guard_config import read_config
from rtron.guard.supervision.programs import leave_terminal, open_descriptors
from rtron.guard.system.process_attributes import outlive_parent
from rtron.guard.system.process_port import accept


def main(numbers: str) -> None:
    """Record what comes over the connection that waits at the port, until that ends.

    It hears no SIGTERM, and outlives the fork server: what was noted last is still saved.
    """
    leave_terminal()
    outlive_parent()
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    config_file, port = open_descriptors(numbers)
    start_logging(read_config(config_file).log_level, "incidents")
    with socket.socket(fileno=port) as accepting_side:
        accepted = accept(accepting_side)
    if accepted:
        run_recorder(accepted[0])
