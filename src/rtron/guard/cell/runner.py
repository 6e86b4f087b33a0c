"""Running a node in a cell: the cell's gateway, which stays outside, and its end."""

import grp
import logging
import os
import pwd
import shutil
import signal
import socket
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

from pydantic import ConfigDict, TypeAdapter, ValidationError, with_config

from rtron.errors import InputError, SourceError
from rtron.guard.cell.access import (
    CARRIER_SUFFIX,
    IDENTITY_SIZE,
    SHARED_FOLDER,
    socket_name,
)
from rtron.guard.cell.config import READY, REFUSED, START, CellConfig
from rtron.guard.cell.isolation import (
    Gap,
    Outside,
    describe_outside,
    listen_for_guards,
    may_be_changed,
    start_in_namespaces,
    take_unused_user,
    take_user,
)
from rtron.guard.core.event_loop import EventLoop
from rtron.guard.supervision.programs import command
from rtron.guard.system.process_attributes import allow_many_files
from rtron.guard.system.unix_socket import open_own_folder, runtime_folder
from rtron.vocabulary import CarriedService, CarriedTopic, CellManifest, Plan, may_pass

if TYPE_CHECKING:
    import subprocess

    from rtron.guard.cell.ros1.gateway import Ros1Gateway
    from rtron.guard.cell.ros2.gateway import Ros2Gateway

log = logging.getLogger(__name__)

_INIT = "cell_programs:run_init"
_POLL_S = 0.05
_START_S = 30.0
_MAX_PACKET = 256
_MAX_BYTES = 1 << 20
_HIGHEST_USER = 2**32 - 2
"""The next one means no change to setreuid(2): the node would stay root."""
_FOLDER_HELP = "set XDG_RUNTIME_DIR to a folder of your own (mode 700)"
_ROOT_HELP = "start the cell as root, or let it be open: --allow-shared-user"


@with_config(ConfigDict(extra="forbid", strict=True))
@dataclass(frozen=True, slots=True, kw_only=True)
class CellDocument:
    """The JSON document, its keys as they are written."""

    schema: Literal["rtron.cell/1"]
    node: str
    published: tuple[CarriedTopic, ...] = ()
    subscribed: tuple[CarriedTopic, ...] = ()
    served: tuple[CarriedService, ...] = ()
    called: tuple[CarriedService, ...] = ()
    parameters: tuple[str, ...] = ()


_DOCUMENT = TypeAdapter(CellDocument)


def read_manifest(path: Path) -> CellManifest:
    """Read a manifest; raise InputError where it is wrong."""
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot be read: {error.strerror}", path=str(path)) from None
    if len(data) > _MAX_BYTES:
        raise InputError(f"has over {_MAX_BYTES} bytes", path=str(path))
    try:
        document = _DOCUMENT.validate_json(data)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"])) or "the file"
        raise InputError(f"{place}: {first['msg']}", path=str(path)) from None
    topics = (each.topic for each in (*document.published, *document.subscribed))
    services = (each.service for each in (*document.served, *document.called))
    for name in (*topics, *services):
        if not may_pass(name):
            why = f"{name!r} is no full name, or one that the guard alone leads into the cell"
            raise InputError(why, path=str(path))
    return CellManifest(
        node=document.node,
        published=document.published,
        subscribed=document.subscribed,
        served=document.served,
        called=document.called,
        parameters=document.parameters,
    )


@dataclass(frozen=True, slots=True, kw_only=True)
class CellRequest:
    """A node that is to run in a cell: its command, and the users of node and guard.

    `files` are those that plan and manifest came from. `address` is the app's master or domain.
    `user` is a name or a number, empty for one that nobody has; `guard_user` is a name, empty for
    who starts the cell.
    """

    plan: Plan
    manifest: CellManifest
    address: str
    command: Sequence[str]
    files: tuple[Path, ...] = ()
    user: str = ""
    guard_user: str = ""
    allowed: frozenset[Gap] = frozenset()
    log_level: str = "INFO"


def run_cell(request: CellRequest) -> int:
    """Run a node in a cell; return its exit code.

    InputError if the plan has no such cell or the users do not exist, SourceError if the system
    does not give what a cell needs.
    """
    if request.manifest.node not in request.plan.cell:
        node = request.manifest.node
        raise InputError(f"the plan has no cell for {node}", help=f"add `cell: [{node}]` to it")
    _check_carried(request)
    if os.getuid() == 0:
        _tell_changeable(request)
    allow_many_files()
    outside = describe_outside()
    config = _cell_config(request, outside)
    loop = EventLoop()
    paths, sockets = _open_access(request)
    try:
        return _CellProcess(loop, request, config, sockets).run()
    finally:
        for path in paths:
            Path(path).unlink(missing_ok=True)
        loop.close()


def _check_carried(request: CellRequest) -> None:
    """Refuse a manifest of more than the gateway carries: nothing is left out in silence."""
    manifest = request.manifest
    if request.plan.ros == 1:
        return
    if manifest.parameters:
        help = "list the node's parameter services: see docs/cell.md"
        raise InputError("there are no shared parameters in ROS 2", help=help)
    for each in (*manifest.served, *manifest.called):
        if not each.type:
            help = "write it as `package/srv/Name`"
            raise InputError(f"the manifest does not give the type of {each.service}", help=help)


def _tell_changeable(request: CellRequest) -> None:
    """Tell of files with which others than root decide what is in the next cell."""
    program = shutil.which(request.command[0])
    words = (Path(word) for word in (program or "", *request.command[1:]))
    for path in (*request.files, *(each for each in words if each.is_absolute())):
        if path.is_file() and may_be_changed(path):
            log.warning("%s may be changed by others than root: who does is in the cell", path)


def _cell_config(request: CellRequest, outside: Outside) -> CellConfig:
    node, guard = _node_user(request, outside), request.guard_user
    own_number = 0 if os.getuid() else os.getuid()
    guards = (own_number, pwd.getpwnam(guard).pw_uid) if guard else (own_number,)
    return CellConfig(
        plan=request.plan,
        manifest=request.manifest,
        command=_without_log_file(request.command) if node.is_other else tuple(request.command),
        outside=outside,
        identity=os.urandom(IDENTITY_SIZE),
        user=node.user,
        group=node.group,
        groups=node.groups,
        home=node.home,
        guard_users=guards,
        allowed=request.allowed,
        log_level=request.log_level,
    )


@dataclass(frozen=True, slots=True)
class _NodeUser:
    user: int
    group: int
    groups: tuple[int, ...]
    home: str
    is_other: bool


def _node_user(request: CellRequest, outside: Outside) -> _NodeUser:
    """Return who the node runs as, as the cell numbers users: an own user where we are root."""
    if os.getuid():
        if Gap.SHARED_USER not in request.allowed:
            why = "a cell of an ordinary user can be entered by all processes of this user"
            raise SourceError(why, help=_ROOT_HELP)
        return _NodeUser(0, 0, (0,), os.environ.get("HOME", ""), is_other=False)
    if not request.user and Gap.SHARED_USER in request.allowed:
        groups = tuple(os.getgroups())
        return _NodeUser(0, os.getgid(), groups, os.environ.get("HOME", ""), is_other=False)
    SHARED_FOLDER.mkdir(mode=0o755, exist_ok=True)
    if not request.user:
        user = take_unused_user(request.manifest.node, outside, SHARED_FOLDER)
        return _NodeUser(user, user, (), "", is_other=True)
    account = _account(request.user)
    is_taken = not take_user(account.user, SHARED_FOLDER)
    if is_taken and Gap.SHARED_USER not in request.allowed:
        why = f"the user {request.user} is that of another cell, which could enter this one"
        raise SourceError(why, help="give each cell a user of its own: --user")
    return account


def _account(name: str) -> _NodeUser:
    if name.isdecimal() and int(name) <= _HIGHEST_USER:
        return _NodeUser(int(name), int(name), (), "", is_other=True)
    try:
        entry = pwd.getpwnam(name)
    except KeyError:
        help = f"make it: useradd --system --groups dialout {name}"
        raise InputError(f"there is no user {name}", help=help) from None
    groups = tuple(group.gr_gid for group in grp.getgrall() if name in group.gr_mem)
    home = entry.pw_dir if Path(entry.pw_dir).is_dir() else ""
    return _NodeUser(entry.pw_uid, entry.pw_gid, groups, home, is_other=True)


def _without_log_file(command: Sequence[str]) -> tuple[str, ...]:
    """Return a command without the log file of roslaunch, which another user cannot write."""
    return tuple(word for word in command if not word.startswith("__log:="))


def _open_access(request: CellRequest) -> tuple[tuple[str, str], list[socket.socket]]:
    """Return where the guard gets in, and the sockets there: for sockets, and for carriers."""
    name = socket_name(request.address, request.manifest.node)
    user = os.getuid()
    if request.guard_user:
        folder = SHARED_FOLDER
        folder.mkdir(mode=0o755, exist_ok=True)
        try:
            user = pwd.getpwnam(request.guard_user).pw_uid
        except KeyError:
            raise InputError(f"there is no user {request.guard_user}") from None
    else:
        folder = runtime_folder()
        os.close(open_own_folder(folder, _FOLDER_HELP))
    paths = (str(folder / name), str(folder / name) + CARRIER_SUFFIX)
    kinds = (socket.SOCK_SEQPACKET, socket.SOCK_STREAM)
    return paths, [listen_for_guards(*each, user) for each in zip(paths, kinds, strict=True)]


class _CellProcess:
    """The cell's first process, seen from the gateway, which waits for it."""

    def __init__(
        self,
        loop: EventLoop,
        request: CellRequest,
        config: CellConfig,
        sockets: Sequence[socket.socket],
    ) -> None:
        self._loop = loop
        self._request = request
        self._config = config
        self._sockets = sockets
        self._gateway: Ros1Gateway | Ros2Gateway | None = None
        self._control, self._theirs = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        self._process: subprocess.Popen[bytes] | None = None
        self._refusal = ""
        self._code = 1

    def run(self) -> int:
        """Start the cell, and carry until its node ends; return the node's exit code."""
        for number in (signal.SIGINT, signal.SIGTERM):
            signal.signal(number, lambda number, _: self._loop.post(lambda: self._end(number)))
        self._start()
        self._loop.run()
        if self._gateway:
            self._gateway.close()
        if self._refusal:
            raise SourceError(f"no cell: {self._refusal}", help=_help(self._refusal))
        return self._code

    def _start(self) -> None:
        descriptors = (
            self._config.write_to_memory(),
            self._theirs.fileno(),
            *(each.fileno() for each in self._sockets),
        )
        program = command(_INIT, descriptors)
        self._process = start_in_namespaces(program, descriptors, _environ(self._request))
        os.close(descriptors[0])
        self._theirs.close()
        for each in self._sockets:
            each.close()
        self._control.settimeout(0)
        self._loop.watch(self._control, self._on_control, lambda _: None)
        self._loop.call_later(_POLL_S, self._poll)

    def _on_control(self) -> None:
        message = self._control.recv(_MAX_PACKET)
        if message == READY:
            self._open_gateway()
        elif message.startswith(REFUSED):
            self._refusal = message[len(REFUSED) :].decode().strip()
        else:
            self._loop.unwatch(self._control)

    def _open_gateway(self) -> None:
        self._gateway = open_gateway(self._loop, self._request)
        self._gateway.open(lambda: self._send(START))

    def _end(self, number: int) -> None:
        self._send(str(int(number)).encode())

    def _send(self, message: bytes) -> None:
        with suppress(OSError):  # the cell has ended
            self._control.send(message)

    def _poll(self) -> None:
        code = self._process.poll() if self._process else 1
        if code is None:
            self._loop.call_later(_POLL_S, self._poll)
        else:
            self._code = code if code >= 0 else 128 - code
            self._loop.stop()


def open_gateway(loop: EventLoop, request: CellRequest) -> "Ros1Gateway | Ros2Gateway":
    """Return the gateway of a cell."""
    if request.plan.ros != 1:
        from rtron.guard.cell.ros2.gateway import Ros2Gateway  # noqa: PLC0415 - it needs rclpy

        return Ros2Gateway(loop, request.address, request.manifest)
    from rtron.guard.cell.ros1.gateway import Ros1Gateway  # noqa: PLC0415 - ROS 2 does without it

    return Ros1Gateway(loop, request.address, request.manifest)


def _environ(request: CellRequest) -> dict[str, str]:
    """Return the environment in the cell; InputError if nothing can be carried with this one."""
    if request.plan.ros != 1:
        from rtron.guard.cell.ros2.environ import cell_environ  # noqa: PLC0415

        return cell_environ(request.address, os.environ)
    from rtron.guard.cell.ros1.gateway import NODE_ENVIRON  # noqa: PLC0415

    left = {"ROS_HOSTNAME", "ROS_IPV6", "ROS_HOME", "ROS_LOG_DIR"}
    inherited = {name: text for name, text in os.environ.items() if name not in left}
    return {**inherited, **NODE_ENVIRON}


def _help(refusal: str) -> str:
    flags = {"SHARED_USER": "--allow-shared-user", "SHARED_MEMORY": "--allow-shared-memory"}
    named = [flag for name, flag in flags.items() if name in refusal]
    return f"see the log; to have it open: {' '.join(named)}" if named else "see the log"
