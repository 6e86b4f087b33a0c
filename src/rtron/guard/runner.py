"""Running the guard until it is told to end."""

from __future__ import annotations

import gc
import logging
import resource
import signal
import sys
from functools import partial
from typing import TYPE_CHECKING

from rtron.errors import SourceError
from rtron.guard.audit.ros1.auditor import Auditor
from rtron.guard.complaints import Complaints
from rtron.guard.core.control_socket import Answer, Control, control_path
from rtron.guard.core.coordinator import Host
from rtron.guard.core.event_loop import Loop
from rtron.guard.core.handover_state import Will
from rtron.guard.core.node_shutdown import Obeying, Refusing
from rtron.guard.core.observations import senses_of
from rtron.guard.master_proxy.master_file import private_master
from rtron.guard.measurement.run import Measuring, Write
from rtron.guard.presence import Presence, presence_path
from rtron.guard.settings.overrides import Overriding
from rtron.guard.transport.factory import open_transport
from rtron.guard.transport.ros1.middleware import Ros1Transport
from rtron.vocabulary import Plan, streams

if TYPE_CHECKING:
    from pathlib import Path

    from rtron.guard.audit.ros2.auditor import Ros2Auditor
    from rtron.guard.link.options import LinkOptions
    from rtron.guard.link.service_link import Linked
    from rtron.guard.supervision.supervisor_client import Tie
    from rtron.guard.transport.ros2.middleware import Ros2Transport

    AnyTransport = Ros1Transport | Ros2Transport

log = logging.getLogger(__name__)

_SWITCH_S = 1e-4


def run_guard(
    plan: Plan,
    master: str,
    *,
    dry_run: bool = False,
    control: Path | None = None,
    figures: Write | None = None,
    tie: Tie | None = None,
    link: LinkOptions | None = None,
) -> int:
    """Guard a plan's streams on the master or in the domain at `master`; return the exit code.

    A dry run lets everything pass and reports what would have become of it. `control` is where
    the guard listens for overrides, by default in the user's runtime folder. `figures` keeps what
    is measured meanwhile. `tie` connects the guard to its supervisor, `link` to the security
    service, whose last settings are put in force first. SourceError if the plan is for ROS 2, which
    is not installed here, or if `control` cannot be used.
    """
    _allow_many_connections()
    loop = Loop()
    transport = open_transport(plan.ros, master, loop)
    measuring = Measuring(plan, transport) if figures else None
    senses = measuring.senses if measuring else senses_of(plan)
    presence = Presence(presence_path(control or control_path(plan.app), master))
    will = _will(tie, presence)
    host = Host(transport, streams(plan), senses, dry_run=dry_run, will=will)
    linked = _linked(plan, host, transport, loop, link) if link else None
    if tie:
        _tie(tie, host, transport, loop)
    if measuring and figures:
        measuring.watch(host.guarded)
        measuring.keep(figures)
    door = _door(loop, plan, control, Overriding(host, transport).answer)
    if door and not dry_run:
        presence.keep(loop)
    _hear_complaints(host, transport)
    auditor = _auditor(plan, master, host, transport, loop, dry_run=dry_run)
    run_host(host, transport, loop, auditor, tie, linked)
    if measuring and figures:
        figures(measuring.run())
    if door:
        door.close()
    loop.close()
    return 0


def _linked(
    plan: Plan, host: Host, transport: AnyTransport, loop: Loop, link: LinkOptions
) -> Linked:
    from rtron.guard.link.service_link import Linked  # noqa: PLC0415 - most guards have no service

    return Linked(plan, host, transport, loop, link)


def _will(tie: Tie | None, presence: Presence) -> Will:
    """Return what the guard before has left, and when it was last there."""
    will = tie.will if tie else Will()
    will.left_at = presence.before
    return will


def _tie(tie: Tie, host: Host, transport: AnyTransport, loop: Loop) -> None:
    """Connect the guard to its supervisor, and let the audit know who that is."""
    tie.open(loop, host)
    if not isinstance(transport, Ros1Transport):
        transport.processes.supervisor = lambda: tie.supervisor


def _door(loop: Loop, plan: Plan, control: Path | None, answer: Answer) -> Control | None:
    """Open the door for overrides; where nobody chose it, the robot is guarded without one too."""
    try:
        return Control(loop, control or control_path(plan.app), answer)
    except SourceError as error:
        if control:
            raise
        log.warning("no overrides: %s", error)
        return None


def _hear_complaints(host: Host, transport: AnyTransport) -> None:
    """Let what the transport cannot hear be an alarm, where it is the transport that judges it."""
    if not isinstance(transport, Ros1Transport):
        transport.tell(Complaints(host.alarms, transport).take)


def _auditor(
    plan: Plan, master: str, host: Host, transport: AnyTransport, loop: Loop, *, dry_run: bool
) -> Auditor | Ros2Auditor:
    if isinstance(transport, Ros1Transport):
        behind = private_master(master)
        return Auditor(plan, behind, host, transport, loop, dry_run=dry_run)
    from rtron.guard.audit.ros2.auditor import Ros2Auditor  # noqa: PLC0415 - it needs rclpy

    return Ros2Auditor(plan, host, transport, loop, dry_run=dry_run)


def run_host(
    host: Host,
    transport: AnyTransport,
    loop: Loop,
    auditor: Auditor | Ros2Auditor | None = None,
    tie: Tie | None = None,
    linked: Linked | None = None,
) -> None:
    """Guard until SIGINT, SIGTERM or, unless it is supervised, a kill of the guard's own node."""
    if isinstance(transport, Ros1Transport):
        shutdowns = Refusing(loop) if tie else Obeying(host, transport, loop)
        asked = auditor if isinstance(auditor, Auditor) else None
        transport.killed = partial(_killed, shutdowns, asked)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: loop.post(loop.stop))
    host.open()
    if linked:
        linked.open()
    if auditor:
        auditor.start()
    _favour_messages()
    log.info("guarding %d topics", len(host.guarded))
    loop.run()
    if linked:
        linked.close()
    if tie:
        tie.close()
    if auditor:
        auditor.close()
    transport.close()


def _killed(shutdowns: Refusing | Obeying, auditor: Auditor | None, node: str, reason: str) -> None:
    if auditor:
        auditor.shut(node, reason, partial(shutdowns.shut, node, reason))
    else:
        shutdowns.shut(node, reason)


def _favour_messages() -> None:
    """Keep garbage collection and the threads that talk to the master out of a message's way."""
    gc.collect()
    gc.freeze()
    sys.setswitchinterval(_SWITCH_S)


def _allow_many_connections() -> None:
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
