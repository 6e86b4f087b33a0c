"""What separates a cell from the rest of the machine: measured in the cell, not believed.

A network namespace alone is open: Fast DDS speaks through files in /dev/shm, and who runs as the
same user may enter (nsenter(1), pidfd_getfd(2)).
"""

import fcntl
import os
import shutil
import socket
import subprocess
from collections.abc import Collection, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from stat import S_ISDIR, S_ISVTX, S_IWGRP, S_IWOTH

from rtron.errors import SourceError

_OPTIONS = ("--net", "--mount", "--ipc", "--pid", "--fork", "--kill-child", "--mount-proc")
_AS_USER = ("--user", "--map-root-user")
_HELP = "start it as root, or let users make namespaces: sysctl user.max_user_namespaces"


def namespace_command() -> list[str]:
    """Return the command that runs another one in a cell; SourceError if there is none."""
    program = shutil.which("unshare")
    if program is None:
        raise SourceError("unshare is not installed", help="it is part of util-linux")
    return [program, *(_AS_USER if os.getuid() else ()), *_OPTIONS, "--"]


def start_in_namespaces(
    command: Sequence[str], descriptors: Sequence[int], environ: Mapping[str, str]
) -> "subprocess.Popen[bytes]":
    """Start a command as the first process of a cell, in a session of its own.

    A signal for the group of who starts it does not reach the node, which has its own moment to
    end.
    """
    return subprocess.Popen(  # noqa: S603 - our own program
        [*namespace_command(), *command],
        pass_fds=descriptors,
        env=dict(environ),
        start_new_session=True,
    )


def listen_for_guards(path: str, kind: int, user: int) -> socket.socket:
    """Return the socket at which the guard's user gets into the cell.

    SourceError if the place is taken by a cell that is there.
    """
    sock = socket.socket(socket.AF_UNIX, kind)
    with socket.socket(socket.AF_UNIX, kind) as other:
        if other.connect_ex(path) == 0:
            sock.close()
            raise SourceError(f"another cell is at {path}", help="end it first")
    if os.path.lexists(path):
        os.unlink(path)  # noqa: PTH108 - left by one that was killed
    before = os.umask(0o177)
    try:
        sock.bind(path)
    finally:
        os.umask(before)
    os.chown(path, user, -1)
    sock.listen()
    return sock


_PROC = Path("/proc")
SHARED_MEMORY = Path("/dev/shm")  # noqa: S108 - what is looked at, not a place for our files
_NAMESPACES = ("net", "mnt", "ipc", "pid")
_ID_MAP_FIELDS = 3


class Gap(str, Enum):
    """A separation that a cell lacks."""

    NETWORK = "the network is shared: every node can speak to it"
    PROCESSES = "its processes are not in a namespace of their own: they may outlive it"
    SHARED_USER = (
        "the user is shared: each process of this user can enter the cell (nsenter, pidfd_getfd)"
    )
    SHARED_MEMORY = (
        "/dev/shm is shared: each process can speak to it by the shared memory of Fast DDS"  # noqa: S108
    )


@dataclass(frozen=True, slots=True)
class Outside:
    """What is outside: the namespaces, the file system of shared memory, the users."""

    namespaces: tuple[int, ...]
    shared_memory: int
    users: frozenset[int]


def describe_outside() -> Outside:
    """Return what a cell has to differ from, seen by who starts it."""
    return Outside(namespaces(), SHARED_MEMORY.stat().st_dev, process_users())


def find_gaps(outside: Outside, user: int) -> tuple[Gap, ...]:
    """Return what this process, which is in the cell, does not have for itself.

    `user` is who the node will run as, as this process numbers users.
    """
    return tuple(_gaps(outside, user))


def _gaps(outside: Outside, user: int) -> Iterator[Gap]:
    net, mount, ipc, pid = (
        here != there for here, there in zip(namespaces(), outside.namespaces, strict=True)
    )
    if not net or [name for _, name in socket.if_nameindex()] != ["lo"]:
        yield Gap.NETWORK
    if not pid:
        yield Gap.PROCESSES
    if outer_user(user) in outside.users:
        yield Gap.SHARED_USER
    if not (mount and ipc) or SHARED_MEMORY.stat().st_dev == outside.shared_memory:
        yield Gap.SHARED_MEMORY


def namespaces() -> tuple[int, ...]:
    """Return the numbers of this process's namespaces, that of the network first."""
    return tuple((_PROC / "self" / "ns" / name).stat().st_ino for name in _NAMESPACES)


def process_users(without: Collection[int] = ()) -> frozenset[int]:
    """Return the users of all processes that are seen from here, `without` some of them."""
    users = set()
    for process in _PROC.iterdir():
        if process.name.isdigit() and int(process.name) not in without:
            with suppress(FileNotFoundError):  # it has ended
                users.add(process.stat().st_uid)
    return frozenset(users)


def may_be_changed(path: Path) -> bool:
    """Tell whether others than root may change a file, or put another in its place."""
    there = path.resolve()
    return any(_is_open(each.stat()) for each in (there, *there.parents))


def _is_open(status: os.stat_result) -> bool:
    mode = status.st_mode
    is_shared = mode & S_IWOTH or (mode & S_IWGRP and status.st_gid)
    keeps_names = S_ISDIR(mode) and mode & S_ISVTX
    return bool(status.st_uid or (is_shared and not keeps_names))


def outer_user(user: int) -> int:
    """Return what a user of this namespace is outside (user_namespaces(7), /proc/self/uid_map)."""
    for line in (_PROC / "self" / "uid_map").read_text().splitlines():
        inner, outer, count = (int(field) for field in line.split()[:_ID_MAP_FIELDS])
        if inner <= user < inner + count:
            return outer + user - inner
    return user


def take_unused_user(name: str, outside: Outside, folder: Path) -> int:
    """Return a user id that no process, account or other cell has, for the cell of a node.

    It is this process's until it ends, by a lock in `folder`: no process shows that a user is
    taken before the node starts. systemd gives out ids of the same range (DynamicUser).
    """
    first, last = 61184, 65519
    start = sum(name.encode()) % (last - first)
    for offset in range(last - first):
        user = first + (start + offset) % (last - first)
        is_free = user not in outside.users and not _has_account(user)
        if is_free and take_user(user, folder):
            return user
    raise OSError("no user id is free")


def take_user(user: int, folder: Path) -> bool:
    """Take a user for the cell of this process, until that ends; False if another cell has it."""
    path = folder / f"user-{user}"
    descriptor = os.open(path, os.O_RDWR | os.O_CREAT | os.O_CLOEXEC, 0o600)
    try:
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        os.close(descriptor)
        return False
    return True


def _has_account(user: int) -> bool:
    import pwd  # noqa: PLC0415

    try:
        pwd.getpwuid(user)
    except KeyError:
        return False
    return True
