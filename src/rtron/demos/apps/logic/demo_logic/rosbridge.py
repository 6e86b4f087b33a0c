"""What rosbridge does with its clients: it lets everybody say everything, under its own name.

It stands for rosbridge_suite, of which there are no wheels: as much of WebSocket (RFC 6455) and of
rosbridge's protocol as the demo needs, and like that without sign-in and rights.
"""

import json
import struct
from base64 import b64encode
from collections.abc import Callable
from contextlib import suppress
from hashlib import sha1
from socketserver import StreamRequestHandler, ThreadingTCPServer
from threading import Lock, Thread
from typing import Any

Message = dict[str, Any]
OnPublish = Callable[[str, Message], None]
"""Takes the topic and the fields of a message that some client publishes."""
_KEY, _GUID = "sec-websocket-key", "258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
_FINAL_TEXT, _CLOSE = 0x81, 8
_SHORT, _LONG = 126, 127


class Rosbridge(ThreadingTCPServer):
    """Serves clients in threads of their own until the process ends."""

    allow_reuse_address = daemon_threads = True

    def __init__(self, port: int, on_publish: OnPublish) -> None:
        super().__init__(("127.0.0.1", port), _WebClient)
        self.on_publish = on_publish
        self._lock = Lock()
        self._clients: set[_WebClient] = set()
        Thread(target=self.serve_forever, name="rosbridge", daemon=True).start()

    def send(self, topic: str, message: Message) -> None:
        """Send a message to all clients."""
        text = json.dumps({"op": "publish", "topic": topic, "msg": message})
        with self._lock:
            for client in self._clients:
                client.send(text)

    def add(self, client: "_WebClient") -> None:
        """Send to a client from now on."""
        with self._lock:
            self._clients.add(client)

    def remove(self, client: "_WebClient") -> None:
        """Send to a client no more."""
        with self._lock:
            self._clients.discard(client)


class _WebClient(StreamRequestHandler):
    server: Rosbridge

    def handle(self) -> None:
        if not self._accept():
            return
        self.server.add(self)
        try:
            while (text := self._read()) is not None:
                frame = json.loads(text)
                if frame["op"] == "publish":
                    self.server.on_publish(frame["topic"], frame["msg"])
        finally:
            self.server.remove(self)

    def send(self, text: str) -> None:
        """Send a text; a client that has gone does not get it."""
        data = text.encode()
        length = bytes([len(data)]) if len(data) < _SHORT else struct.pack("!BH", _SHORT, len(data))
        with suppress(OSError):
            self.wfile.write(bytes([_FINAL_TEXT]) + length + data)

    def _accept(self) -> bool:
        """Answer the handshake; tell whether there was one."""
        headers = {}
        while line := self.rfile.readline().decode().strip():
            name, _, value = line.partition(":")
            headers[name.lower()] = value.strip()
        if _KEY not in headers:
            return False
        digest = sha1((headers[_KEY] + _GUID).encode(), usedforsecurity=False).digest()
        self.wfile.write(
            b"HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
            b"Sec-WebSocket-Accept: " + b64encode(digest) + b"\r\n\r\n"
        )
        return True

    def _read(self) -> bytes | None:
        """Return the next text, None at the end; frames of clients are masked."""
        head = self.rfile.read(2)
        if len(head) < len("ab") or head[0] & 0xF == _CLOSE:
            return None
        length = head[1] & _LONG
        if length >= _SHORT:
            form = "!H" if length == _SHORT else "!Q"
            (length,) = struct.unpack(form, self.rfile.read(struct.calcsize(form)))
        mask, data = self.rfile.read(4), self.rfile.read(length)
        return bytes(byte ^ mask[n % len(mask)] for n, byte in enumerate(data))
