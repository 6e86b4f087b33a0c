"""The supervisor as a program."""

import sys

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.log_format import start_logging
from rtron.guard.supervision.fork_server import ForkServer
from rtron.guard.supervision.guard_config import read_config
from rtron.guard.supervision.preload import preload
from rtron.guard.supervision.programs import open_descriptors, run_program
from rtron.guard.supervision.supervisor import Supervisor
from rtron.guard.system.machine_time import check_steady_clock
from rtron.guard.system.process_attributes import set_process_name
from rtron.guard.transport.factory import share_memory


def main(numbers: str) -> None:
    """Supervise the guard of the configuration in an open file; end with the exit code."""
    (config_file,) = open_descriptors(numbers)
    set_process_name("rtron-supervisor")
    config = read_config(config_file)

    def supervise() -> int:
        check_steady_clock()
        preload(config)
        server = ForkServer()  # before there is a thread or a node of ours
        start_logging(config.log_level, "supervisor")
        share_memory(config.plan.ros, on=False)
        return Supervisor(config, config_file, EventLoop(), server).run()

    sys.exit(run_program(supervise))
