"""Tokens end by default; a guard's link renews its own over the connection that it has."""

import asyncio
import shutil
import stat
import threading
from concurrent.futures import ThreadPoolExecutor
from contextlib import closing, contextmanager
from dataclasses import replace

import pytest
from controller_setup import hello, plan
from harness import wait_for
from sqlalchemy import select
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from rtron.guard.link.audit_heads import HeadsFile
from rtron.guard.link.options import LinkOptions
from rtron.guard.link.service_connection import ServiceConnection
from rtron.guard.link.spool import Spool
from rtron.service.collector.close_codes import CloseCode
from rtron.service.store.accounts.random_secrets import secret_digest
from rtron.service.store.tables import TokenRow
from rtron.wire.common.link_protocol import (
    RenewedToken,
    RenewedTokenStored,
    decode_to_guard,
    encode_from_guard,
)

DAY = 86_400
LIMIT_S = 120
ME = "/api/v1/me"


@pytest.fixture
def app(app):
    """Give a service that looks often, so that a test need not wait."""
    app.state.collector.token_renewal._interval_s = 0.05
    app.state.collector.token_watch._interval_s = 0.05
    return app


@pytest.fixture
def token_file(people, tmp_path):
    folder = tmp_path / "robot"
    folder.mkdir()
    headers = people.token_headers("car1", "guard", robot="car1", days=90)
    (folder / "car1.token").write_text(headers["Authorization"].removeprefix("Bearer ") + "\n")
    return folder / "car1.token"


@contextmanager
def running_link(port, token_file):
    """Run the link's end of the connection in a thread, as the link process does."""
    state = token_file.parent / "state"
    options = LinkOptions(
        service=f"http://127.0.0.1:{port}", token_file=token_file, robot="car1", state=state
    )
    options.prepare()
    loops, begun = [], threading.Event()

    async def run():
        with closing(Spool(options.spool_file)) as spool:
            heads_file = HeadsFile(options.audit_heads_file)
            link = ServiceConnection(options, spool, lambda _: None, heads_file)
            link.announce(replace(hello(plan()), robot="car1", renews_token=True))
            task = asyncio.create_task(link.run())
            loops.extend([asyncio.get_running_loop(), task])
            begun.set()
            await asyncio.gather(task, return_exceptions=True)

    thread = threading.Thread(target=asyncio.run, args=[run()])
    thread.start()
    assert begun.wait(LIMIT_S)
    try:
        yield
    finally:
        loop, task = loops
        loop.call_soon_threadsafe(task.cancel)
        thread.join(LIMIT_S)
        shutil.rmtree(options.counter_folder, ignore_errors=True)
        assert not thread.is_alive()


def bearer(secret):
    return {"Authorization": f"Bearer {secret.strip()}"}


def row(app):
    with app.state.service.database.session() as session:
        return session.scalars(select(TokenRow).where(TokenRow.robot == "car1")).one()


def test_a_guard_renews_its_token_without_an_interruption(app, port, client, clock, token_file):
    first = token_file.read_text()
    end = row(app).expires
    with running_link(port, token_file):
        wait_for(lambda: app.state.service.hub.is_connected("car1"), what="the connection")
        clock.sleep(60 * DAY - 1)
        checked = client.get(ME, headers=bearer(first))
        assert checked.status_code == 200
        assert token_file.read_text() == first
        clock.sleep(1)
        wait_for(lambda: row(app).previous_digest == secret_digest(first.strip()))
        second = token_file.read_text()
        assert row(app).digest == secret_digest(second.strip())
        assert stat.S_IMODE(token_file.stat().st_mode) == 0o600
        assert client.get(ME, headers=bearer(first)).status_code == 401
        assert client.get(ME, headers=bearer(second)).status_code == 200
        clock.now = end + DAY * 1_000_000_000
        assert row(app).expires > clock.now
        wait_for(lambda: app.state.collector.token_watch._connections, what="the connection")
        assert app.state.collector.counters.connections == 1
        assert app.state.service.hub.is_connected("car1")
    with running_link(port, token_file):
        wait_for(lambda: app.state.collector.counters.connections == 2, what="another connection")


def test_a_token_that_cannot_be_kept_stays_the_old_one(app, port, client, clock, token_file):
    def fail(_self, _secret):
        raise PermissionError(13, "Permission denied")

    first = token_file.read_text()
    with pytest.MonkeyPatch.context() as patch, running_link(port, token_file):
        patch.setattr(LinkOptions, "replace_token", fail)
        wait_for(lambda: app.state.service.hub.is_connected("car1"), what="the connection")
        clock.sleep(60 * DAY)
        wait_for(lambda: row(app).next_digest, what="the offer")
        offered = row(app).next_digest
        assert client.get(ME, headers=bearer(first)).status_code == 200
        assert row(app).digest == secret_digest(first.strip())
        assert row(app).next_digest == offered  # once an hour, not each time that it looks
        assert app.state.service.hub.is_connected("car1")


def test_an_old_guard_is_offered_nothing(app, port, clock, token_file):
    headers = bearer(token_file.read_text())
    with connect(f"ws://127.0.0.1:{port}/link/v1", additional_headers=headers, proxy=None) as old:
        old.send(encode_from_guard(hello(plan())), text=True)
        old.recv(timeout=LIMIT_S)
        clock.sleep(60 * DAY)
        with pytest.raises(TimeoutError):
            old.recv(timeout=0.5)
        assert row(app).next_digest is None


def test_a_renewal_that_was_not_offered_ends_the_connection(port, token_file):
    headers = bearer(token_file.read_text())
    with connect(f"ws://127.0.0.1:{port}/link/v1", additional_headers=headers, proxy=None) as liar:
        liar.send(encode_from_guard(hello(plan())), text=True)
        liar.recv(timeout=LIMIT_S)
        liar.send(encode_from_guard(RenewedTokenStored()), text=True)
        with pytest.raises(ConnectionClosed) as closed:
            liar.recv(timeout=LIMIT_S)
    assert closed.value.rcvd.code == CloseCode.MALFORMED


def test_a_lost_confirmation_locks_nobody_out(app, port, client, clock, token_file):
    """The guard has stored the secret, and the connection breaks before it can say so."""
    first, url = bearer(token_file.read_text()), f"ws://127.0.0.1:{port}/link/v1"
    with connect(url, additional_headers=first, proxy=None) as guard:
        guard.send(encode_from_guard(replace(hello(plan()), renews_token=True)), text=True)
        guard.recv(timeout=LIMIT_S)
        clock.sleep(60 * DAY)
        offer = decode_to_guard(guard.recv(timeout=LIMIT_S))
        assert isinstance(offer, RenewedToken)
        assert offer.token not in repr(offer)
    assert client.get(ME, headers=first).status_code == 200
    assert client.get(ME, headers=bearer(offer.token)).status_code == 200
    assert client.get(ME, headers=first).status_code == 401


def test_a_program_renews_its_token(client, people, clock):
    first = people.token_headers("ci", "read", days=10)
    name = client.get(ME, headers=first).json()["name"]
    clock.sleep(9 * DAY)
    answer = client.post("/api/v1/tokens/renewal", headers=first)
    assert answer.status_code == 201
    assert answer.json()["expires"] == clock.now + 10 * DAY * 1_000_000_000
    second = bearer(answer.json()["secret"])
    assert client.get(ME, headers=first).status_code == 200
    assert client.get(ME, headers=second).status_code == 200
    assert client.get(ME, headers=first).status_code == 401
    stolen = "refused: the secret before the renewal, which may be stolen"
    auditor = people.session_headers("anna", "admin")
    entries = client.get("/api/v1/audit", headers=auditor).json()["entries"]
    audited = [(e["action"], e["outcome"]) for e in entries if e["who"] == name]
    assert audited == [("use token", stolen), ("renew token", "done")]
    clock.sleep(10 * DAY - 1)
    assert client.get(ME, headers=second).status_code == 200
    clock.sleep(1)
    assert client.post("/api/v1/tokens/renewal", headers=second).status_code == 401


def test_of_two_programs_with_one_token_one_renews_it(client, people):
    first = people.token_headers("ci", "read")
    with ThreadPoolExecutor(2) as threads:
        posts = [threads.submit(client.post, "/api/v1/tokens/renewal", headers=first) for _ in "ab"]
        answers = sorted((post.result() for post in posts), key=lambda each: each.status_code)
    assert [each.status_code for each in answers] == [201, 409]
    assert answers[1].json()["error"] == "the token is being renewed by somebody else"
    assert client.get(ME, headers=first).status_code == 200
    assert client.get(ME, headers=bearer(answers[0].json()["secret"])).status_code == 200


def test_only_tokens_are_renewed(client, admin):
    assert client.post("/api/v1/tokens/renewal", headers=admin).status_code == 403
    assert client.post("/api/v1/tokens/renewal").status_code == 401


def test_a_token_of_an_older_version_stays_without_an_end_until_it_is_renewed(
    app, client, people, clock
):
    first = people.token_headers("old", "read")
    with app.state.service.database.session() as session:
        old = session.scalars(select(TokenRow)).one()
        old.expires = old.lifetime = None
    clock.sleep(1000 * DAY)
    assert client.get(ME, headers=first).status_code == 200
    answer = client.post("/api/v1/tokens/renewal", headers=first).json()
    assert answer["expires"] == clock.now + 90 * DAY * 1_000_000_000
    assert client.get(ME, headers=bearer(answer["secret"])).status_code == 200
    clock.sleep(90 * DAY)
    assert client.get(ME, headers=bearer(answer["secret"])).status_code == 401
