"""How our TCP connections are set: no delay, and a peer whose machine died is noticed."""

import socket

_OPTIONS = (
    (socket.IPPROTO_TCP, socket.TCP_NODELAY, 1),
    (socket.SOL_SOCKET, socket.SO_KEEPALIVE, 1),
    (socket.IPPROTO_TCP, socket.TCP_KEEPIDLE, 10),
    (socket.IPPROTO_TCP, socket.TCP_KEEPINTVL, 5),
    (socket.IPPROTO_TCP, socket.TCP_KEEPCNT, 3),
)


def set_socket_options(sock: socket.socket) -> None:
    """Set the options of a connected socket; keep-alive gives up after 25 s of silence."""
    for level, name, value in _OPTIONS:
        sock.setsockopt(level, name, value)
