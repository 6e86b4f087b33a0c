"""The guard as a program that a supervisor starts."""

import gc
import logging
import os
import select
import socket
import sys

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.lanes.command.command_process import run_command_process
from rtron.guard.log_format import start_logging
from rtron.guard.supervision.guard_config import read_config, stopped_streams
from rtron.guard.supervision.preload import prepare_plan
from rtron.guard.supervision.programs import leave_terminal, open_descriptors, run_program
from rtron.guard.supervision.shared_memory import BEGIN, GuardMemory, StatusWord
from rtron.guard.supervision.supervisor_client import SupervisorClient
from rtron.guard.system.process_attributes import outlive_parent
from rtron.guard.transport.factory import prepare_session, share_memory

log = logging.getLogger(__name__)

_DISCOVERY_S = 4.0
"""How long it takes to know a domain: Fast DDS asks after what was lost every 3 s."""


def main(numbers: str) -> None:
    """Guard with the configuration, the memory and the connection in open files; end with the code.

    Not before the supervisor says so: a spare guard waits here, and ends with the supervisor.
    """
    leave_terminal()
    config_file, port, memory_file, number = open_descriptors(numbers)
    connection = socket.socket(fileno=number)
    config = read_config(config_file)
    start_logging(config.log_level)
    memory = GuardMemory(memory_file, len(stopped_streams(config.plan)))
    share_memory(config.plan.ros, on=config.options["dry_run"])
    session = prepare_session(config.plan.ros, config.master)
    prepare_plan(config.plan)
    gc.collect()
    gc.freeze()
    if session:
        select.select([connection], (), (), _DISCOVERY_S)
    memory[StatusWord.READY] = EventLoop.now()
    if connection.recv(len(BEGIN)) != BEGIN:
        if session:
            session.close()
        return
    outlive_parent()  # without it, it stops the robot first
    log.info("the guard begins, process %d", os.getpid())

    def guard() -> int:
        client = SupervisorClient(config, memory, connection, socket.socket(fileno=port), session)
        options = dict(config.options)
        if options.pop("dry_run"):
            from rtron.guard.dry_run import run_dry  # noqa: PLC0415 - loaded before

            run_dry(config.plan, config.master, client, **options)
        else:
            del options["figures"]  # a dry run's
            run_command_process(config.plan, config.master, client, **options)
        return 0

    sys.exit(run_program(guard))
