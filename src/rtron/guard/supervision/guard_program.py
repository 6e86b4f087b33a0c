"""The guard as a program that a supervisor starts."""

import signal
import socket
import sys

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.dry_run import run_dry
from rtron.guard.lanes.command_process import run_command_process
from rtron.guard.log_format import start_logging
from rtron.guard.supervision.guard_config import read_config, stopped_streams
from rtron.guard.supervision.programs import open_descriptors, run_program
from rtron.guard.supervision.shared_memory import GuardMemory, StatusWord
from rtron.guard.supervision.supervisor_client import SupervisorClient
from rtron.guard.supervision.supervisor_handover import BEGIN
from rtron.guard.transport.factory import load_middleware


def main(numbers: str) -> None:
    """Guard with the configuration, the memory and the connection in open files; end with the code.

    Not before the supervisor says so: a spare guard waits here, and ends with the supervisor.
    """
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, {signal.SIGINT})
    config_file, memory_file, number = open_descriptors(numbers)
    connection = socket.socket(fileno=number)
    config = read_config(config_file)
    start_logging(config.log_level)
    memory = GuardMemory(memory_file, len(stopped_streams(config.plan)))
    load_middleware(config.plan.ros)
    memory[StatusWord.READY] = EventLoop.now()
    if connection.recv(len(BEGIN)) != BEGIN:
        return

    def guard() -> int:
        client = SupervisorClient(config, memory, connection, config_file)
        options = dict(config.options)
        if options.pop("dry_run"):
            run_dry(config.plan, config.master, client, **options)
        else:
            del options["figures"]  # a dry run's
            run_command_process(config.plan, config.master, client, **options)
        return 0

    sys.exit(run_program(guard))
