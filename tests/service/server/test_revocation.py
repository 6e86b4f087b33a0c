"""A token that is revoked ends its guard's connection at once, with nobody looking it up again."""

from contextlib import contextmanager

import httpx
import pytest
from controller_setup import hello, plan
from service_app import serve_in_thread
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from rtron.service.collector.close_codes import CloseCode
from rtron.wire.common.link_protocol import NewSettings, decode_to_guard, encode_from_guard

LIMIT_S = 120


def test_a_revocation_ends_the_connection_and_no_other(app, people):
    app.state.collector.token_watch._interval_s = 3600
    admin = people.session_headers("mary", "admin")
    with (
        serve_in_thread(app) as port,
        _guard(port, people.token_headers("one", "guard", robot="r1")) as first,
        _guard(port, people.token_headers("two", "guard", robot="r2")) as second,
    ):
        url = f"http://127.0.0.1:{port}/api/v1/tokens"
        names = [each["name"] for each in httpx.get(url, headers=admin).json()]
        revoked = next(name for name in names if name.startswith("one"))
        assert httpx.delete(f"{url}/{revoked}", headers=admin).status_code == 204
        with pytest.raises(ConnectionClosed) as closed:
            first.recv(timeout=LIMIT_S)
        assert closed.value.rcvd.code == CloseCode.NO_TOKEN
        assert second.ping().wait(LIMIT_S)
        assert app.state.service.hub.is_connected("r2")


@contextmanager
def _guard(port, headers):
    url = f"ws://127.0.0.1:{port}/link/v1"
    with connect(url, additional_headers=headers, proxy=None, open_timeout=LIMIT_S) as socket:
        socket.send(encode_from_guard(hello(plan())), text=True)
        assert isinstance(decode_to_guard(socket.recv(timeout=LIMIT_S)), NewSettings)
        yield socket
