"""The bridge on real sockets: who gets in, who does not, and what ends a connection."""

import json
import os
import socket
import struct
from contextlib import ExitStack, suppress
from functools import partial
from itertools import count

import pytest
from bridge_parts import RIGHTS, TOKEN
from harness import wait_for
from memory_bridge import LIMIT_S, hear, memory_bridge, say
from websockets.exceptions import ConnectionClosed, InvalidStatus

from rtron.bridge.rights.tokens import token_hash
from rtron.bridge.server import client_connection
from rtron.errors import SourceError

OTHER = "rtb_screen"


@pytest.fixture
def bridge():
    with memory_bridge() as running:
        yield running


@pytest.fixture
def web(bridge):
    with bridge.connect(TOKEN) as connection:
        yield connection


def ended(connection):
    """Return why a connection ends, once it has."""
    with pytest.raises(ConnectionClosed) as raised:
        repeat(lambda: connection.recv(LIMIT_S))
    close = raised.value.rcvd
    return (close.code, close.reason) if close else None


def repeat(work, most=None):
    """Do it again and again, until it raises an error, or `most` times."""
    for _ in count() if most is None else range(most):
        work()


def status_of(bridge, *arguments, **options):
    with pytest.raises(InvalidStatus) as raised:
        bridge.connect(*arguments, **options)
    return raised.value.response.status_code


def connections(bridge):
    return bridge.in_loop(lambda: len(bridge.bridge._connections))


# Signing in.


def test_a_client_signs_in_by_header_by_address_or_by_its_first_frame(bridge):
    with bridge.connect(TOKEN) as one:
        assert one.response.headers["RTron-Node"] == "/bridge/web"
        say(one, "call_service", service="/rosapi/topics")
        assert hear(one)["result"]
    with bridge.connect(path=f"/?token={OTHER}") as other:
        say(other, "call_service", service="/rosapi/topics")
        assert hear(other)["values"]["topics"] == ["/chat"]
    wait_for(lambda: "web" not in bridge.in_loop(lambda: bridge.bridge._clients))
    with bridge.connect() as third:
        say(third, "auth", mac=TOKEN, client="x", dest="y", rand="z", t=0, level="a", end=0)
        say(third, "call_service", service="/rosapi/services")
        assert hear(third)["values"] == {"services": ["/lamp"]}


@pytest.mark.parametrize("token", ["rtb_nobody", "x" * 1000, "ä"])
def test_a_wrong_token_gets_no_websocket(bridge, token):
    path = "/?token=" + "".join(f"%{byte:02x}" for byte in token.encode())
    assert status_of(bridge, path=path) == 401
    assert bridge.nodes == {}
    wait_for(lambda: connections(bridge) == 0)


@pytest.mark.parametrize(
    ("frame", "why"),
    [
        ({"op": "auth", "mac": "wrong"}, "that token is nobody's"),
        ({"op": "auth"}, "that token is nobody's"),
        ({"op": "publish", "topic": "/chat", "msg": {}}, "sign in first"),
        ({"op": "call_service", "service": "/rosapi/topics"}, "sign in first"),
        ({"op": "call_service", "service": "/rosapi/get_param"}, "sign in first"),
    ],
)
def test_a_stranger_gets_nothing_but_a_reason(bridge, frame, why):
    with bridge.connect() as stranger:
        stranger.send(json.dumps(frame))
        told = hear(stranger)
        assert (told["op"], told["level"]) == ("status", "error")
        assert why in told["msg"]
        assert ended(stranger)[0] == 4401
    assert bridge.nodes == {}


def test_no_token_gets_into_the_log(bridge, caplog):
    caplog.set_level("DEBUG", logger="rtron")
    with bridge.connect(path=f"/?token={TOKEN}"), bridge.connect(OTHER):
        assert status_of(bridge, "rtb_wrong") == 401
    with bridge.connect() as third:
        say(third, "auth", mac="rtb_wrong_too")
        ended(third)
    assert "signs in from 127.0.0.1" in caplog.text
    assert "rtb_" not in caplog.text


def test_a_stranger_that_sends_much_before_its_sign_in_is_dropped(bridge):
    with socket.create_connection(("127.0.0.1", bridge.port)) as stranger:
        stranger.sendall(handshake(bridge))
        stranger.settimeout(LIMIT_S)
        pings = 0
        with suppress(ConnectionError):
            while stranger.recv(1 << 12):
                stranger.sendall(masked(9, b"x" * 125))
                pings += 1
    assert 100 < pings < 500
    wait_for(lambda: connections(bridge) == 0)


def test_a_stranger_that_is_silent_is_dropped(bridge, monkeypatch):
    monkeypatch.setattr(client_connection, "SIGN_IN_TIMEOUT_S", 0.1)
    with bridge.connect() as stranger:
        assert ended(stranger) == (4401, "no sign-in in time")
    with socket.create_connection(("127.0.0.1", bridge.port)) as client:
        client.settimeout(LIMIT_S)
        assert client.recv(100) == b""


def test_one_connection_of_a_client_at_a_time(bridge, web):
    assert status_of(bridge, TOKEN) == 401
    say(web, "call_service", service="/rosapi/topics")
    assert hear(web)["result"]
    assert len(bridge.opened) == 1


def test_a_client_whose_connection_is_silent_is_replaced(bridge):
    with frozen(bridge, TOKEN):
        first = bridge.nodes["web"]
        wait_for(lambda: not bridge.in_loop(lambda: bridge.bridge._clients["web"].is_present))
        with bridge.connect(TOKEN) as second:
            say(second, "call_service", service="/rosapi/topics")
            assert hear(second)["result"]
            assert first.is_closed
            assert not bridge.nodes["web"].is_closed


def frozen(bridge, token):
    """Return a signed-in connection that answers no ping: a bare socket."""
    connection = socket.create_connection(("127.0.0.1", bridge.port))
    connection.sendall(handshake(bridge, f"Authorization: Bearer {token}"))
    assert b"101 Switching" in connection.recv(1 << 12)
    wait_for(lambda: bridge.nodes)
    return connection


def handshake(bridge, *headers, host=None):
    lines = (
        "GET / HTTP/1.1",
        f"Host: {host or f'127.0.0.1:{bridge.port}'}",
        "Upgrade: websocket",
        "Connection: Upgrade",
        "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==",
        "Sec-WebSocket-Version: 13",
        *headers,
    )
    return "\r\n".join((*lines, "", "")).encode()


def test_no_more_clients_than_the_file_says():
    with memory_bridge(RIGHTS + "max_clients: 1\n") as bridge, bridge.connect(TOKEN):
        assert status_of(bridge, OTHER) == 401


def test_the_node_leaves_with_its_client(bridge):
    with bridge.connect(TOKEN) as web:
        say(web, "publish", topic="/chat", msg={"data": "last words"})
    wait_for(lambda: bridge.nodes["web"].is_closed)
    assert [each[0] for each in bridge.nodes["web"].done] == ["advertise", "publish"]
    wait_for(lambda: connections(bridge) == 0)


def test_a_node_that_is_shut_down_ends_its_client_s_connection(bridge, web):
    bridge.in_loop(lambda: bridge.nodes["web"].listener.on_shutdown("rosnode kill"))
    assert ended(web) == (1001, "the node was shut down: rosnode kill")


def test_a_port_that_is_taken_is_an_error(bridge):
    with pytest.raises(SourceError, match="Address already in use"):
        bridge.in_loop(lambda: bridge.bridge.listen("127.0.0.1", bridge.port))


# Pages and hosts.


@pytest.mark.parametrize(
    ("origin", "status"),
    [
        ("https://evil.example", 403),
        ("https://robot.example.evil.example", 403),
        ("http://robot.example", 403),
        ("http://127.0.0.1", 403),
        ("http://localhost:8080", 403),
        ("null", 403),
        ("file://", 403),
        ("", 403),
    ],
)
def test_the_page_of_a_stranger_gets_nothing(bridge, origin, status):
    assert status_of(bridge, TOKEN, headers={"Origin": origin}) == status
    assert bridge.nodes == {}


def test_a_page_that_the_file_names_and_a_program_that_names_the_bridge_get_in(bridge):
    for origin in ("https://robot.example", f"http://127.0.0.1:{bridge.port}"):
        with bridge.connect(TOKEN, headers={"Origin": origin}) as page:
            say(page, "call_service", service="/rosapi/topics")
            assert hear(page)["result"]
        wait_for(lambda: connections(bridge) == 0)


@pytest.mark.parametrize(
    ("host", "answer"),
    [
        ("evil.example", b"421"),
        ("localhost.evil.example:9090", b"421"),
        ("", b"421"),
        ("localhost", b"101"),
        ("LOCALHOST:9090", b"101"),
        ("10.1.2.3:9090", b"101"),
        ("[::1]:9090", b"101"),
        ("x\r\nHost: localhost", b"421"),
    ],
)
def test_a_name_that_points_here_by_dns_gets_nothing(bridge, host, answer):
    with socket.create_connection(("127.0.0.1", bridge.port)) as client:
        client.sendall(handshake(bridge, host=host or " "))
        assert client.recv(1 << 12).split()[1] == answer


# What is malformed.


@pytest.mark.parametrize(
    "data",
    [
        b"\0" * 100 + b"\r\n\r\n",
        b"GET / HTTP/1.1\r\n\r\n",
        b"POST / HTTP/1.1\r\nHost: localhost\r\n\r\n",
        b"GET / HTTP/1.1\r\n" + b"x: y\r\n" * 1000 + b"\r\n",
        b"GET /" + b"a" * 10_000 + b" HTTP/1.1\r\n\r\n",
        os.urandom(5000),
    ],
)
def test_what_is_no_handshake_ends_the_connection(bridge, data):
    with socket.create_connection(("127.0.0.1", bridge.port)) as client:
        client.sendall(data)
        client.settimeout(LIMIT_S)
        try:
            while client.recv(1 << 16):
                continue
        except ConnectionResetError:
            pass
    wait_for(lambda: connections(bridge) == 0)


def masked(opcode, payload, *, fin=True, length=None):
    """Return a frame as a client sends it; `length` is what it announces."""
    size = len(payload) if length is None else length
    head = struct.pack(">BBQ", (0x80 if fin else 0) | opcode, 0x80 | 127, size)
    return head + bytes(4) + payload


@pytest.mark.parametrize(
    ("frame", "code"),
    [
        (masked(1, b"", length=1 << 62), 1009),
        (masked(1, b"x" * 10_001), 1009),
        (masked(1, b"x" * 6000, fin=False) + masked(0, b"x" * 6000), 1009),
        (masked(1, b"\xff\xfe"), 1007),
        (masked(3, b""), 1002),
        (masked(0, b""), 1002),
        (b"\xff\xff" + bytes(20), 1002),
        (b"\x81\x01x", 1002),
    ],
)
def test_what_is_no_frame_ends_the_connection_with_a_code(bridge, frame, code):
    with frozen(bridge, TOKEN) as client:
        client.sendall(frame)
        client.settimeout(LIMIT_S)
        answer = client.recv(1 << 12)
        while answer[0] == 0x89:
            answer = answer[2:] or client.recv(1 << 12)
        assert (answer[0], struct.unpack(">H", answer[2:4])[0]) == (0x88, code)
    wait_for(lambda: bridge.nodes["web"].is_closed)


def test_a_frame_in_pieces_is_whole(bridge, web):
    web.send(['{"op": "call_service",', '"service": "/rosapi/services"}'])
    assert hear(web)["values"] == {"services": ["/lamp"]}


def test_a_binary_frame_is_refused_with_a_reason(bridge, web):
    web.send(b"\xa0")
    assert hear(web)["msg"] == "binary frames are refused: send JSON"


def test_compression_is_not_offered(bridge):
    with bridge.connect(TOKEN, compression="deflate") as web:
        assert web.protocol.extensions == []


# Floods, and those who do not read.


def test_connections_that_do_not_sign_in_are_bounded_and_keep_nobody_out(bridge):
    silent = [socket.create_connection(("127.0.0.1", bridge.port)) for _ in range(100)]
    wait_for(lambda: 0 < connections(bridge) <= 64)
    with bridge.connect(TOKEN) as web:
        say(web, "call_service", service="/rosapi/topics")
        assert hear(web)["result"]
    for each in silent:
        each.close()
    wait_for(lambda: connections(bridge) == 0)


def test_a_flood_of_frames_ends_the_connection_and_no_other_one(bridge, web):
    with bridge.connect(OTHER) as screen:
        with pytest.raises(ConnectionClosed):
            repeat(lambda: web.send("{}"))
        assert ended(web)[0] == 1008
        say(screen, "call_service", service="/rosapi/topics")
        assert hear(screen)["result"]


def test_a_flood_of_pings_that_reads_no_answer_takes_no_memory(caplog):
    caplog.set_level("INFO", logger="rtron")
    quick = RIGHTS.replace("frames: 100,", "frames: 10000,")
    with memory_bridge(quick) as fast, frozen(fast, TOKEN) as client:
        client.settimeout(LIMIT_S)
        ping = masked(9, b"x" * 125) * 500
        with pytest.raises(OSError, match=r"reset|pipe|timed out"):
            repeat(lambda: client.sendall(ping))
        wait_for(lambda: fast.nodes["web"].is_closed)
    assert "/bridge/web has left: the client does not read" in caplog.text


def test_a_flood_of_pings_behind_a_message_that_is_not_read_takes_no_memory(caplog):
    caplog.set_level("INFO")
    text = RIGHTS.replace("frames: 100, bytes: 100000", "frames: 10000, bytes: 100000")
    with memory_bridge(text) as bridge, frozen(bridge, TOKEN) as client:
        client.settimeout(LIMIT_S)
        subscribe = {"op": "subscribe", "topic": "/chat", "queue_length": 5}
        client.sendall(masked(1, json.dumps(subscribe).encode()))
        wait_for(lambda: ("read", "/chat", "std_msgs/String") in bridge.nodes["web"].done)
        sent = bridge.in_loop(lambda: bridge.bridge._clients["web"]._socket)
        node, message = bridge.nodes["web"], struct.pack("<II", 9004, 9000) + bytes(9000)
        while bridge.in_loop(lambda: sent.can_send):
            bridge.in_loop(lambda: node.listener.on_message("/chat", message))
        with pytest.raises(OSError, match=r"reset|pipe|timed out"):
            repeat(lambda: client.sendall(masked(9, b"x" * 125) * 50), most=2000)
        wait_for(lambda: node.is_closed)
    assert "the client does not read" in caplog.text


def test_a_flood_of_parts_of_a_message_that_never_ends_ends_the_connection(bridge):
    with frozen(bridge, TOKEN) as client:
        client.settimeout(LIMIT_S)
        client.sendall(masked(1, b"{", fin=False))
        parts = masked(0, b"", fin=False) * 500
        with suppress(OSError):  # the connection may have ended before all is sent
            repeat(lambda: client.sendall(parts), most=20)
        wait_for(lambda: bridge.nodes["web"].is_closed, what="the end of the connection")


def read_chat(bridge, connection):
    say(connection, "subscribe", topic="/chat", type="std_msgs/String")
    wait_for(lambda: ("read", "/chat", "std_msgs/String") in bridge.nodes["web"].done)


def test_a_slow_reader_loses_the_oldest_messages_and_is_told_how_many(bridge):
    rate = RIGHTS.replace("rate: 100}", "rate: 10000}").replace(
        "message: 10000", "message: 1000000"
    )
    with memory_bridge(rate) as fast, fast.connect(TOKEN, max_queue=1) as slow:
        read_chat(fast, slow)
        node = fast.nodes["web"]
        for number in range(200):
            body = b"%06d" % number + b"x" * 200_000
            message = struct.pack("<II", 4 + len(body), len(body)) + body
            fast.in_loop(lambda message=message: node.listener.on_message("/chat", message))
        heard, told = [], None
        while told is None:
            frame = hear(slow)
            if frame["op"] == "status":
                told = frame
            else:
                heard.append(int(frame["msg"]["data"][:6]))
    assert heard == sorted(heard)
    assert heard[-1] == 199
    assert told["level"] == "warning"
    assert told["msg"] == f"{200 - len(heard)} messages were dropped: you read too slowly"


def test_who_never_reads_its_answers_is_disconnected(bridge):
    quick = RIGHTS.replace("frames: 100,", "frames: 10000,").replace(
        "bytes: 100000", "bytes: 1000000000"
    )
    with memory_bridge(quick) as fast, frozen(fast, TOKEN) as client:
        client.settimeout(LIMIT_S)
        call = {"op": "call_service", "service": "/rosapi/topics", "id": "x" * 256}
        ask = masked(1, json.dumps(call).encode())
        with pytest.raises(OSError, match=r"reset|pipe|timed out"):
            repeat(lambda: client.sendall(ask))
        wait_for(lambda: fast.nodes["web"].is_closed)


def test_a_slow_reader_delays_nobody(bridge):
    with frozen(bridge, TOKEN) as client, bridge.connect(OTHER) as screen:
        client.sendall(masked(1, b'{"op": "subscribe", "topic": "/chat"}'))
        say(screen, "subscribe", topic="/chat")
        wait_for(lambda: bridge.nodes["screen"].done and bridge.nodes["web"].done)
        message = struct.pack("<II", 6, 2) + b"hi"
        for node in bridge.nodes.values():
            bridge.in_loop(lambda node=node: node.listener.on_message("/chat", message))
        assert hear(screen)["msg"] == {"data": "hi"}


def hundred_rights():
    entry = """
  - name: c{n}
    tokens: ["{token}"]
    subscribe: [{{{{topic: /chat, type: std_msgs/String, rate: 10000}}}}]
    limits: {{{{message: 1000000, queue: 10}}}}"""
    clients = (entry.format(n=n, token=token_hash(f"rtb_c{n}")) for n in range(100))
    return "schema: rtron.bridge/1\nmax_clients: 100\nclients:" + "".join(clients)


def test_a_hundred_clients_of_which_ten_do_not_read():
    with memory_bridge(hundred_rights()) as bridge, ExitStack() as stack:
        silent = [stack.enter_context(silent_reader(bridge, f"rtb_c{n}")) for n in range(10)]
        readers = [
            stack.enter_context(bridge.connect(f"rtb_c{n}", max_queue=None)) for n in range(10, 100)
        ]
        for reader in readers:
            say(reader, "subscribe", topic="/chat")
        wait_for(lambda: len(bridge.nodes) == 100)
        wait_for(lambda: all(node.done for node in bridge.nodes.values()))
        for number in range(60):
            body = b"%06d" % number + b"x" * 20_000
            message = struct.pack("<II", 4 + len(body), len(body)) + body
            for node in list(bridge.nodes.values()):
                bridge.loop.post(partial(node.listener.on_message, "/chat", message))
            heard = [int(hear(reader)["msg"]["data"][:6]) for reader in readers]
            assert heard == [number] * 90
        lost = [
            bridge.in_loop(lambda node=node: node.listener._outbox.dropped)
            for node in slow_nodes(bridge)
        ]
        assert all(lost)
        assert len(silent) == 10


def slow_nodes(bridge):
    return [bridge.nodes[f"c{n}"] for n in range(10)]


def silent_reader(bridge, token):
    """Return a connection that has subscribed to /chat and never reads."""
    connection = socket.socket()
    connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 1 << 12)
    connection.connect(("127.0.0.1", bridge.port))
    connection.sendall(handshake(bridge, f"Authorization: Bearer {token}"))
    connection.sendall(masked(1, b'{"op": "subscribe", "topic": "/chat"}'))
    return connection
