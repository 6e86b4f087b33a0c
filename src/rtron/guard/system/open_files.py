"""How many files and sockets a process may have open (getrlimit(2))."""

import resource


def allow_many_files() -> None:
    """Let this process open as many files as its hard limit allows: each connection is one."""
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))
