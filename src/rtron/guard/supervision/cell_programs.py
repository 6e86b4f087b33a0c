"""The processes in a cell as programs; the first of them starts the others."""

import os
import select
import signal
import socket
import sys
from typing import TYPE_CHECKING

from rtron.guard.cell.access import CellState
from rtron.guard.cell.access_server import AccessServer
from rtron.guard.cell.config import CellConfig, read_cell_config
from rtron.guard.cell.init import CellInit
from rtron.guard.cell.isolation import Gap, find_gaps, namespaces, outer_user
from rtron.guard.cell.stopper import CellStopper
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.log_format import start_logging
from rtron.guard.supervision.guard_config import stopped_streams
from rtron.guard.supervision.programs import (
    TERMINAL_SIGNALS,
    open_descriptors,
    run_program,
    start_program,
)
from rtron.guard.system.unix_socket import peer_credentials
from rtron.guard.transport.common.protocol import LiveTransport
from rtron.guard.transport.ros1.celled_transport import (
    CELL_HOST,
    PRIVATE_MASTER,
    PRIVATE_PORT,
    PUBLIC_PORT,
)
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.vocabulary import matches_node

if TYPE_CHECKING:
    import subprocess

STOPPER = "cell_programs:run_stopper"
MASTER = "cell_programs:run_cell_master"
CARRIER = "cell_programs:run_carrier"
_CARRIERS = 5
"""For guard, supervisor, gateway, the next guard, and `rtron verify`."""


def run_init(numbers: str) -> None:
    """Be the first process of a cell; end with the exit code of its node."""
    config_file, number, access, carriers = open_descriptors(numbers)
    config = read_cell_config(config_file)
    start_logging(config.log_level, "cell")
    control = socket.socket(fileno=number)

    def start(program: str) -> "subprocess.Popen[bytes]":
        return start_program(program, (config_file, access, carriers))

    ros1, ros2 = ((MASTER, PUBLIC_PORT), (STOPPER, 0)), ((STOPPER, 0), *[(CARRIER, 0)] * _CARRIERS)
    services = ros1 if config.plan.ros == 1 else ros2
    sys.exit(run_program(lambda: CellInit(config, control, start, services).run()))


def run_stopper(numbers: str) -> None:
    """Stop the robot when nobody guards it, and let the guard in."""
    config, access, carriers = _open(numbers, "cell stopper")
    carriers.close()
    loop = EventLoop()
    transport = _open_transport(config, loop)
    server = AccessServer(
        loop,
        access,
        config.identity,
        config.guard_users,
        _state(config),
        lambda: stopper.look(),  # noqa: PLW0108 - it comes later
    )
    streams = tuple(
        each
        for each in stopped_streams(config.plan)
        if any(matches_node(name, config.manifest.node) for name in each.successors)
    )
    stopper = CellStopper(loop, transport, streams, server, is_carried=config.plan.ros != 1)
    stopper.open()
    loop.run()


def run_cell_master(numbers: str) -> None:
    """Be the master of a cell, which lets the node do what the plan lets it do."""
    from rtron.guard.master_proxy.process import run_master  # noqa: PLC0415 - only ROS 1 has one

    config, *sockets = _open(numbers, "cell master")
    for each in sockets:
        each.close()
    sys.exit(
        run_program(
            lambda: run_master(config.plan, CELL_HOST, PUBLIC_PORT, private_port=PRIVATE_PORT)
        )
    )


def run_carrier(numbers: str) -> None:
    """Carry topics for one process of the guard, with a participant that is there before it."""
    from rtron.guard.cell.ros2.carrier import Carrier  # noqa: PLC0415 - only ROS 2 has one
    from rtron.guard.transport.factory import open_ros2_transport  # noqa: PLC0415
    from rtron.wire.ros2.domain_id import domain_address  # noqa: PLC0415

    config, access, carriers = _open(numbers, "cell carrier")
    loop = EventLoop()
    transport = open_ros2_transport(domain_address(), loop)
    client = _await_client(carriers, config)
    Carrier(loop, transport, client, access.getsockname())
    loop.run()
    transport.close()


def _await_client(carriers: socket.socket, config: CellConfig) -> socket.socket:
    """Return the next client that may enter, and that has not left while it waited."""
    while True:
        client, _ = carriers.accept()
        waiting = select.poll()
        waiting.register(client, select.POLLRDHUP)
        is_gone = bool(waiting.poll(0))
        if peer_credentials(client)[1] in config.guard_users and not is_gone:
            return client
        client.close()


def _open(numbers: str, process: str) -> tuple[CellConfig, socket.socket, socket.socket]:
    config_file, access, carriers = open_descriptors(numbers)
    config = read_cell_config(config_file)
    os.close(config_file)
    start_logging(config.log_level, process)
    signal.pthread_sigmask(signal.SIG_UNBLOCK, TERMINAL_SIGNALS)
    return config, socket.socket(fileno=access), socket.socket(fileno=carriers)


def _state(config: CellConfig) -> CellState:
    """Return what the cell tells of itself, with its users as they are outside."""
    gaps = find_gaps(config.outside, config.user)
    is_shared = Gap.SHARED_USER in gaps
    return CellState(
        namespace=namespaces()[0],
        gaps=tuple(gap.name for gap in gaps),
        guard_users=frozenset(map(outer_user, config.guard_users)),
        shared_users=frozenset({outer_user(config.user)} if is_shared else ()),
    )


def _open_transport(config: CellConfig, loop: EventLoop) -> LiveTransport:
    if config.plan.ros != 1:
        from rtron.guard.transport.factory import open_ros2_transport  # noqa: PLC0415
        from rtron.wire.ros2.domain_id import domain_address  # noqa: PLC0415

        return open_ros2_transport(domain_address(), loop)
    return Ros1Transport(loop, PRIVATE_MASTER, CELL_HOST)
