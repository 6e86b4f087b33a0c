"""The guard as a program that a supervisor starts."""

import gc
import select
import socket
import sys
from contextlib import suppress

from rtron.errors import RTronError
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.core.message_types import standard_info
from rtron.guard.core.observations import observations_of
from rtron.guard.core.report_messages import DIAGNOSTICS, STRING, UINT64
from rtron.guard.lanes.command.command_process import run_command_process
from rtron.guard.log_format import start_logging
from rtron.guard.supervision.guard_config import GuardConfig, read_config, stopped_streams
from rtron.guard.supervision.programs import leave_interrupts, open_descriptors, run_program
from rtron.guard.supervision.shared_memory import BEGIN, GuardMemory, StatusWord
from rtron.guard.supervision.supervisor_client import SupervisorClient
from rtron.guard.transport.factory import load_types, prepare_session, share_memory
from rtron.messages.common.encoding import Encoding
from rtron.vocabulary import build_streams

_DISCOVERY_S = 4.0
"""How long it takes to know a domain: Fast DDS asks after what was lost every 3 s."""


def main(numbers: str) -> None:
    """Guard with the configuration, the memory and the connection in open files; end with the code.

    Not before the supervisor says so: a spare guard waits here, and ends with the supervisor.
    """
    leave_interrupts()
    config_file, memory_file, number = open_descriptors(numbers)
    connection = socket.socket(fileno=number)
    config = read_config(config_file)
    start_logging(config.log_level)
    memory = GuardMemory(memory_file, len(stopped_streams(config.plan)))
    share_memory(config.plan.ros, on=config.options["dry_run"])
    session = prepare_session(config.plan.ros, config.master)
    _load(config)
    if session:
        select.select([connection], (), (), _DISCOVERY_S)
    memory[StatusWord.READY] = EventLoop.now()
    if connection.recv(len(BEGIN)) != BEGIN:
        if session:
            session.close()
        return

    def guard() -> int:
        client = SupervisorClient(config, memory, connection, session)
        options = dict(config.options)
        if options.pop("dry_run"):
            from rtron.guard.dry_run import run_dry  # noqa: PLC0415 - loaded before

            run_dry(config.plan, config.master, client, **options)
        else:
            del options["figures"]  # a dry run's
            run_command_process(config.plan, config.master, client, **options)
        return 0

    sys.exit(run_program(guard))


def _load(config: GuardConfig) -> None:
    """Read message types and compile expressions now: on ROS 2 a definition takes up to 0.4 s.

    What fails here fails again when the guard begins, and is reported there. What only some guards
    need is imported now, too, so that a spare guard begins at once.
    """
    if config.options["dry_run"]:
        import rtron.guard.dry_run  # noqa: PLC0415
    elif config.options.get("link"):
        import rtron.guard.lanes.command.service_parts  # noqa: F401, PLC0415
    plan = config.plan
    encoding = Encoding.ROS1 if plan.ros == 1 else Encoding.CDR
    own = [DIAGNOSTICS[encoding].type, STRING.type, UINT64.type]
    types = [each.type for each in build_streams(plan)]
    with suppress(RTronError):
        observations_of(plan)
        load_types(plan.ros, [*own, *types])
        for type in types:
            standard_info(type, encoding)
    gc.collect()
    gc.freeze()
