"""What is known of a cell from outside: what it lacks, who gets in, and what it does not close.

It is tried to get in as each user who has a process outside: what a user is refused here, the
kernel refuses every process of that user.
"""

import ctypes
import json
import os
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from rtron.errors import SourceError
from rtron.guard.cell.access import CellAccess, CellState
from rtron.guard.cell.isolation import SHARED_MEMORY, Gap, process_users
from rtron.vocabulary import Mode, Plan, UnguardedPath, build_streams, matches_node
from rtron.vocabulary.verification import GuardedPath, PathState, Verification

_CLONE_NEWUSER, _CLONE_NEWNET = 0x10000000, 0x40000000
_SYS_PIDFD_GETFD = 438
"""linux/sched.h, asm-generic/unistd.h"""
_DESCRIPTORS = range(16)
_PROC = Path("/proc")
_MAX_ANSWER = 1 << 16
_ROOT = "root gets in, and so does each node that runs as root"
_OWN_END = "publishes outside the cell: its own end is open to who forges its messages"


LookInside = Callable[[CellAccess], Verification]
"""Compares the plan with what is in a cell; SourceError if nobody in there answers."""


def verify_cells(plan: Plan, address: str, outside: Verification, look: LookInside) -> Verification:
    """Return a verification in which the paths of nodes in cells are those that lead there."""
    found = replace(outside, paths=tuple(_paths_outside(plan, outside)))
    for node in plan.cell:
        access = CellAccess(address, node)
        try:
            inside = look(access)
        except SourceError as error:
            expected = (path for path in outside.paths if path.node == node)
            unknown = (replace(p, state=PathState.UNKNOWN, reason=str(error)) for p in expected)
            found = replace(found, paths=(*found.paths, *unknown))
        else:
            paths = tuple(path for path in inside.paths if path.node == node)
            found = _join(found, replace(inside, paths=paths))
            found = _join(found, _report_cell(plan, access))
    return found


def _paths_outside(plan: Plan, outside: Verification) -> Iterator[GuardedPath]:
    """Yield the paths that lead into no cell; who uses one outside its cell has it open."""
    for path in outside.paths:
        if path.node not in plan.cell:
            yield path
        elif path.state not in (PathState.UNKNOWN, PathState.NOT_SEEN):
            yield replace(path, state=PathState.OPEN, reason="is there outside its cell, too")


def _join(one: Verification, other: Verification) -> Verification:
    return Verification(
        paths=(*one.paths, *other.paths),
        problems=(*one.problems, *other.problems),
        unguarded=(*one.unguarded, *other.unguarded),
        proven=(*one.proven, *other.proven),
    )


def _report_cell(plan: Plan, access: CellAccess) -> Verification:
    """Try to get into a cell, and return what was found; SourceError if it is not there."""
    state = access.state()
    pids = _processes_in(state.namespace)
    gaps = [Gap[name] for name in state.gaps]
    what = f"the cell of {access.node}"
    unguarded = [UnguardedPath(what=what, why=gap.value) for gap in gaps]
    unguarded.append(UnguardedPath(what=what, why=_ROOT))
    unguarded += _open_publishers(plan, access.node)
    unguarded += [
        UnguardedPath(what=what, why=f"who runs as the guard's user {user} gets in, too")
        for user in sorted(state.guard_users - {0})
    ]
    entries = {user: _find_entries(access, pids, user) for user in _strangers(state, pids)}
    refused = ", ".join(str(user) for user, ways in entries.items() if not ways)
    problems = [
        f"a process of user {user} gets into {what}: {way}"
        for user, ways in entries.items()
        for way in ways
    ]
    if Gap.SHARED_MEMORY not in gaps and any(map(_shares_memory, pids)):
        problems.append(f"a process in {what} has the /dev/shm of this machine")
    return Verification(
        paths=(),
        problems=tuple(problems),
        unguarded=tuple(unguarded),
        proven=(f"no process of these users gets into {what}: {refused}",) if refused else (),
    )


def _strangers(state: CellState, pids: Sequence[int]) -> list[int]:
    """Return the users outside who may not get into a cell; `pids` are the processes inside."""
    users = process_users(without=pids) if os.getuid() == 0 else {os.getuid()}
    return sorted(users - {0} - state.guard_users - state.shared_users)


def _open_publishers(plan: Plan, node: str) -> Iterator[UnguardedPath]:
    for stream in build_streams(plan):
        leads_in = any(matches_node(successor, node) for successor in stream.successors)
        for flow in stream.flows if leads_in and stream.mode is Mode.ENFORCE else ():
            if flow.publisher not in plan.cell:
                yield UnguardedPath(what=flow.publisher, why=_OWN_END)


def _find_entries(access: CellAccess, pids: Sequence[int], user: int) -> list[str]:
    """Return the ways that a user has into a cell; only root can try as another user.

    `pids` are the processes in the cell.
    """
    return _as_user(user, lambda: list(_ways(access, pids)))


def _processes_in(namespace: int) -> list[int]:
    """Return the processes in a network namespace, as far as this user may know."""
    found = []
    for process in _PROC.iterdir():
        if process.name.isdigit():
            with suppress(OSError):
                if (process / "ns" / "net").stat().st_ino == namespace:
                    found.append(int(process.name))
    return found


def _as_user(user: int, attempt: Callable[[], list[str]]) -> list[str]:
    """Return what an attempt finds in a process of another user."""
    reader, writer = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reader)
        try:
            if os.getuid() != user:
                os.setgroups([])
                os.setgid(user)
                os.setuid(user)
            os.write(writer, json.dumps(attempt()).encode())
        finally:
            os._exit(0)
    os.close(writer)
    with os.fdopen(reader, "rb") as answer:
        data = answer.read(_MAX_ANSWER)
    os.waitpid(child, 0)
    if not data:
        raise SourceError(f"what user {user} can enter could not be tried")
    ways: list[str] = json.loads(data)
    return ways


def _ways(access: CellAccess, pids: Sequence[int]) -> Iterator[str]:
    if _can_connect(access):
        yield "it gets sockets as the guard does"
    if _can_get_carrier(access):
        yield "it gets a carrier as the guard does"
    if any(_memory_device(pid) for pid in pids):
        yield "it can reach the shared memory of a process in the cell"
    libc = ctypes.CDLL(None, use_errno=True)
    if any(_can_take_descriptor(libc, pid) for pid in pids):
        yield "it can take an open socket of a process in the cell (pidfd_getfd)"
    if any(_can_enter(libc, pid) for pid in pids):  # the last one: it changes this process
        yield "it can enter the network of the cell (nsenter)"


def _can_connect(access: CellAccess) -> bool:
    try:
        access.open_socket().close()
    except SourceError:
        return False
    return True


def _can_get_carrier(access: CellAccess) -> bool:
    """Tell whether a carrier keeps the connection; it ends that of who may not enter."""
    try:
        with access.connect_carrier() as carrier:
            return bool(carrier.recv(1))
    except TimeoutError:
        return True
    except (OSError, SourceError):
        return False


def _shares_memory(pid: int) -> bool:
    return _memory_device(pid) == SHARED_MEMORY.stat().st_dev


def _memory_device(pid: int) -> int:
    """Return the file system of a process's /dev/shm, 0 if it cannot be reached."""
    try:
        return (_PROC / str(pid) / "root" / SHARED_MEMORY.relative_to("/")).stat().st_dev
    except OSError:
        return 0


def _can_take_descriptor(libc: ctypes.CDLL, pid: int) -> bool:
    try:
        process = os.pidfd_open(pid)
    except OSError:
        return False
    try:
        return any(libc.syscall(_SYS_PIDFD_GETFD, process, fd, 0) >= 0 for fd in _DESCRIPTORS)
    finally:
        os.close(process)


def _can_enter(libc: ctypes.CDLL, pid: int) -> bool:
    try:
        network = os.open(_PROC / str(pid) / "ns" / "net", os.O_RDONLY | os.O_CLOEXEC)
    except OSError:
        return False
    with suppress(OSError):
        owner = os.open(_PROC / str(pid) / "ns" / "user", os.O_RDONLY | os.O_CLOEXEC)
        libc.setns(owner, _CLONE_NEWUSER)
    return bool(libc.setns(network, _CLONE_NEWNET) == 0)
