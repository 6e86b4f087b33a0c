"""The bulk process as a program that a supervisor starts."""

import socket
import sys

from rtron.guard.lanes.bulk.bulk_process import BulkPorts, run_bulk_process
from rtron.guard.log_format import start_logging
from rtron.guard.supervision.guard_config import read_config
from rtron.guard.supervision.programs import leave_terminal, open_descriptors, run_program
from rtron.guard.system.sealed_memory import SharedBeat
from rtron.guard.transport.factory import share_memory


def main(numbers: str) -> None:
    """Be the bulk process of the configuration in an open file; end with the exit code."""
    leave_terminal()
    config_file, beat, port, recorder_port = open_descriptors(numbers)
    config = read_config(config_file)
    start_logging(config.log_level, "bulk")
    share_memory(config.plan.ros, on=True)

    def carry() -> int:
        link = config.options.get("link")
        ports = BulkPorts(socket.socket(fileno=port), socket.socket(fileno=recorder_port))
        run_bulk_process(config.plan, config.master, ports, config.digest, SharedBeat(beat), link)
        return 0

    sys.exit(run_program(carry))
