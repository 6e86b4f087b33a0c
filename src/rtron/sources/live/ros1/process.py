"""The package and executable of a node on this machine, from the process behind its address."""

import os
import re
import socket
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from rtron.sources.launch.common.packages import package_name
from rtron.wire.ros1.xmlrpc import split_uri

_PROC = Path("/proc")
_INSTALLED = re.compile(r".*/lib/([a-z][a-z0-9_]*)/([^/]+)")
_PYTHON = re.compile(r"python[0-9.]*")
_OPTIONS_WITHOUT_SCRIPT = (b"-m", b"-c", b"")
_TCP_LISTEN = "0A"
_LOCAL, _STATE, _INODE = 1, 3, 9


@dataclass(frozen=True, slots=True)
class NodeProgram:
    """What a node runs; empty where that is not known."""

    package: str = ""
    executable: str = ""


def find_program(uri: str, pid: int) -> NodeProgram:
    """Return what runs behind a node's address, if it is process `pid` of this machine.

    A node may claim any process id, so it counts only if that process listens on the address's
    port. The script of an interpreter is taken from its command line, which the process itself
    can rewrite: the answer tells people where to look, and is no ground for trust.
    """
    host, port = split_uri(uri)
    process = _PROC / str(pid)
    with suppress(OSError, ValueError):  # it has ended, or we may not look at it
        if _is_this_machine(host) and _is_listening(process, port):
            return _program_at(_program_file(process))
    return NodeProgram()


def _is_this_machine(host: str) -> bool:
    """Tell whether a host's address is one of ours: only then can it be bound."""
    family, kind, _, _, address = socket.getaddrinfo(host, 0, type=socket.SOCK_STREAM)[0]
    with socket.socket(family, kind) as probe:
        try:
            probe.bind(address)
        except OSError:
            return False
    return True


def _is_listening(process: Path, port: int) -> bool:
    descriptors = (str(entry.readlink()) for entry in (process / "fd").iterdir())
    return not _listening_sockets(process, port).isdisjoint(descriptors)


def _listening_sockets(process: Path, port: int) -> set[str]:
    """Return the sockets that listen on a port, in the process's network."""
    sockets = set()
    for table in ("tcp", "tcp6"):
        with suppress(FileNotFoundError):  # a kernel without IPv6 has no tcp6
            for line in (process / "net" / table).read_text().splitlines()[1:]:
                fields = line.split()
                is_listening = fields[_STATE] == _TCP_LISTEN
                if is_listening and fields[_LOCAL].endswith(f":{port:04X}"):
                    sockets.add(f"socket:[{fields[_INODE]}]")
    return sockets


def _program_file(process: Path) -> Path:
    """Return the program's file, for Python that of its script."""
    program = (process / "exe").readlink()
    if not _PYTHON.fullmatch(program.name):
        return program
    arguments = (process / "cmdline").read_bytes().split(b"\0")
    script = _script(arguments[1:])
    return Path(os.path.normpath((process / "cwd").readlink() / os.fsdecode(script)))


def _script(arguments: list[bytes]) -> bytes:
    """Return the script among Python's arguments; ValueError if it runs a module or a text."""
    argument = next(
        argument
        for argument in (*arguments, b"-c")
        if argument in _OPTIONS_WITHOUT_SCRIPT or argument[:1] != b"-"
    )
    if argument in _OPTIONS_WITHOUT_SCRIPT:
        raise ValueError("no script")
    return argument


def _program_at(path: Path) -> NodeProgram:
    installed = _INSTALLED.fullmatch(str(path))
    if installed:
        return NodeProgram(*installed.groups())
    manifests = (folder for folder in path.parents if (folder / "package.xml").is_file())
    folder = next(manifests, None)
    return NodeProgram(package_name(folder) if folder else "", path.name)
