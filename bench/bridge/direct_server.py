"""What passes a published message on to all clients at once, and does nothing else: `PORT`.

The least that any bridge can take: no rights, no check, no ROS.
"""

import sys

from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve

_clients: set[ServerConnection] = set()


def pass_on(client: ServerConnection) -> None:
    """Send each published frame of a client to all."""
    _clients.add(client)
    try:
        for frame in client:
            if '"op": "publish"' in str(frame):
                for each in list(_clients):
                    each.send(frame)
    except ConnectionClosed:
        return
    finally:
        _clients.discard(client)


def main() -> None:
    """Serve until the process is ended."""
    with serve(pass_on, "127.0.0.1", int(sys.argv[1]), compression=None) as server:
        server.serve_forever()


if __name__ == "__main__":
    main()
