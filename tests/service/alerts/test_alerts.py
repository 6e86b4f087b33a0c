import hashlib
import hmac
import json
import ssl

import pytest
from harness import wait_for
from sqlalchemy import text
from webhook_receiver import run_receiver

from rtron.errors import InputError, SourceError
from rtron.service.alerts import dispatcher
from rtron.service.alerts.dispatcher import DuplicateFilter
from rtron.service.alerts.webhook_call import signature
from rtron.service.alerts.webhook_url import parse_webhook_url, resolve_address
from rtron.service.domain.rollouts.observations import rollout_message
from rtron.service.domain.schemas import EventView

HOOKS = "/api/v1/webhooks"
MINUTE = 60_000_000_000
EVENT = {"id": 1, "robot": "car1", "kind": "alarm", "level": "error", "node": "", "topic": "/scan"}


@pytest.fixture
def receiver():
    with run_receiver() as receiver:
        yield receiver


@pytest.fixture
def hook(client, admin, receiver):
    """Add a webhook of the receiver's; return what was answered."""

    def add(level="warning", path="/hook?x=1"):
        url = f"http://127.0.0.1:{receiver.port}{path}"
        answer = client.post(HOOKS, json={"url": url, "level": level}, headers=admin)
        assert answer.status_code == 201
        return answer.json()

    return add


@pytest.fixture
def tell(app, client):
    """Tell the hub of an event."""

    def tell(**changed):
        app.state.service.hub.broadcast({"type": "event", "event": EVENT | changed})

    wait_for(lambda: app.state.service.hub.has_listeners)
    return tell


def number(receiver):
    return json.loads(receiver.call()[2])["event"]["id"]


def failing(client, admin):
    return client.get(HOOKS, headers=admin).json()[0]["failing"]


def test_an_alert_is_posted_and_signed(clock, hook, tell, receiver):
    secret = hook()["secret"]
    tell()
    path, headers, body = receiver.call()
    assert path == "/hook?x=1"
    assert headers["Host"] == f"127.0.0.1:{receiver.port}"
    assert json.loads(body) == {"schema": "rtron.alert/1", "dropped": 0, "event": EVENT}
    seconds = headers["X-RTron-Timestamp"]
    assert int(seconds) == clock.now // 1_000_000_000
    signed = hmac.new(secret.encode(), f"{seconds}.".encode() + body, hashlib.sha256).hexdigest()
    assert headers["X-RTron-Signature"] == f"sha256={signed}"
    assert signature(secret + "x", int(seconds), body) != f"sha256={signed}"


def test_a_rollout_that_goes_back_is_an_alert(app, clock, hook, tell, receiver):
    hook("error")
    broadcast = app.state.service.hub.broadcast
    for message in (rollout_message(7), rollout_message(7, "why"), rollout_message(8, "why")):
        broadcast(message)
    events = [json.loads(receiver.call()[2])["event"] for _ in range(2)]
    assert [each["node"] for each in events] == ["rollout/7", "rollout/8"]
    assert events[0] == {
        "id": 0,
        "robot": "",
        "at": clock.now,
        "kind": "rollout",
        "level": "error",
        "node": "rollout/7",
        "topic": "",
        "flow": "",
        "publisher": "",
        "policy": "",
        "decision": "",
        "reason": "why",
        "revision": 0,
        "values": {},
    }
    assert events[0].keys() == EventView.model_fields.keys()
    assert receiver.calls.empty()


def test_only_what_is_bad_enough_is_sent(hook, tell, receiver):
    hook("error")
    tell(level="info", topic="/a")
    tell(level="warning", topic="/b")
    tell(level="error", topic="/c")
    assert json.loads(receiver.call()[2])["event"]["topic"] == "/c"
    assert receiver.calls.empty()


def test_the_same_alarm_is_not_repeated_within_a_minute(clock, hook, tell, receiver):
    hook()
    tell()
    tell(id=2)
    tell(id=3, topic="/other")
    assert [number(receiver) for _ in range(2)] == [1, 3]
    clock.sleep(59.9)
    tell(id=4)
    tell(id=5, topic="/third")
    assert number(receiver) == 5
    clock.sleep(0.1)
    tell(id=6)
    assert number(receiver) == 6


def test_it_is_sent_again_until_it_is_taken(monkeypatch, hook, tell, receiver, client, admin):
    monkeypatch.setattr(dispatcher, "RETRY_DELAYS_S", (0.0, 0.0, 0.0))
    hook()
    receiver.answers = [500, 429, 503]
    tell()
    assert [number(receiver) for _ in range(4)] == [1] * 4
    assert failing(client, admin) == ""


def test_what_is_given_up_is_shown_and_counted(monkeypatch, hook, tell, receiver, client, admin):
    monkeypatch.setattr(dispatcher, "RETRY_DELAYS_S", (0.0, 0.0, 0.0))
    hook()
    receiver.answers = [500, 404, 500, 418]
    tell()
    wait_for(lambda: failing(client, admin) == "it answered 418")
    for _ in range(4):
        receiver.call()
    tell(id=2, topic="/b")
    assert json.loads(receiver.call()[2])["dropped"] == 1
    wait_for(lambda: failing(client, admin) == "")
    tell(id=3, topic="/c")
    assert json.loads(receiver.call()[2])["dropped"] == 0


def test_no_redirect_is_followed(monkeypatch, hook, tell, receiver, client, admin):
    monkeypatch.setattr(dispatcher, "RETRY_DELAYS_S", ())
    hook()
    receiver.answers = [302]
    tell()
    wait_for(lambda: failing(client, admin) == "it answered 302")
    assert receiver.call()[0] == "/hook?x=1"
    assert receiver.calls.empty()


def test_who_does_not_answer_does_not_hold_up_the_others(
    monkeypatch, hook, tell, receiver, client, admin
):
    dead = client.post(HOOKS, json={"url": "http://127.0.0.1:1/"}, headers=admin)
    assert dead.status_code == 201
    hook()
    tell()
    assert receiver.call()[2]


def test_a_flood_fills_no_memory(monkeypatch, hook, tell, receiver, client, admin):
    monkeypatch.setattr(dispatcher, "RETRY_DELAYS_S", ())
    monkeypatch.setattr(dispatcher, "_MAX_QUEUED", 2)
    hook()
    for each in range(50):
        tell(id=each, topic=f"/{each}")
    told = []
    while sum(each["dropped"] for each in told) + len(told) < 50:
        told.append(json.loads(receiver.call()[2]))
    assert len(told) < 50


def test_after_its_removal_a_webhook_is_silent(hook, tell, receiver, client, admin, clock):
    made = hook()
    tell()
    receiver.call()
    assert client.delete(f"{HOOKS}/{made['id']}", headers=admin).status_code == 204
    assert client.delete(f"{HOOKS}/{made['id']}", headers=admin).status_code == 404
    clock.sleep(1)
    tell(id=2, topic="/b")
    hook(path="/second")
    clock.sleep(1)
    tell(id=3, topic="/c")
    assert receiver.call()[0] == "/second"


def test_a_webhook_in_place_of_another_gets_the_alerts_and_the_other_none(
    hook, tell, receiver, client, admin, clock
):
    made = hook()
    tell()
    receiver.call()
    client.delete(f"{HOOKS}/{made['id']}", headers=admin)
    hook(path="/second")
    clock.sleep(1)
    tell(id=2, topic="/b")
    assert receiver.call()[0] == "/second"
    assert receiver.calls.empty()


def test_tls_is_checked_under_the_hosts_name(monkeypatch, tell, client, admin, certificate):
    """The address was looked up before; the certificate is for the name, and is not trusted."""
    monkeypatch.setattr(dispatcher, "RETRY_DELAYS_S", ())
    context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
    context.load_cert_chain(*certificate)
    with run_receiver(context) as receiver:
        url = f"https://localhost:{receiver.port}/"
        assert client.post(HOOKS, json={"url": url}, headers=admin).status_code == 201
        tell()
        wait_for(lambda: failing(client, admin) == "no connection: ConnectError")
        assert receiver.calls.empty()


@pytest.mark.parametrize(
    "url",
    [
        "http://169.254.169.254/latest/meta-data",
        "http://[fe80::1]/",
        "http://[fd00:ec2::254]/",
        "http://[fd00:ec2::23]/",
        "http://[fd20:ce::254]/",
        "http://[::ffff:169.254.169.254]/",
        "http://[::169.254.169.254]/",
        "http://[64:ff9b::a9fe:a9fe]/",
        "http://[64:ff9b:1::a9fe:a9fe]/",
        "http://[64:ff9b:1:a9fe:a9:fe00:0:1]/",
        "http://[64:ff9b:1:ffa9:fe:a9fe:0:1]/",
        "http://[64:ff9b:1:ffff:a9:fea9:fe00:1]/",
        "http://[::ffff:0:a9fe:a9fe]/",
        "http://[2001:db8::5efe:a9fe:a9fe]/",
        "http://[2001:db8::200:5efe:a9fe:a9fe]/",
        "http://[2002:a9fe:a9fe::1]/",
        "http://[2001:0:a9fe:a9fe::1]/",
        "http://[2001:0:7f00:1::5601:5601]/",
        "http://100.100.100.200/",
        "http://0.0.0.0/",
        "http://[::]/",
        "http://224.0.0.1/",
        "http://user:password@example.org/",
        "http://user@example.org/",
        "ftp://example.org/",
        "http:///path",
        "http://[::1",
        "http://example.org:99999/",
        "http://exämple.org/",
        "http://example.org/a\r\nX: y",
        "",
    ],
)
def test_some_places_get_no_alerts(url):
    with pytest.raises(InputError):
        parse_webhook_url(url)


@pytest.mark.parametrize("host", ["169.254.169.254", "2852039166", "0xa9fea9fe", "0"])
def test_names_that_lead_there_neither(host):
    """Libraries read odd spellings of addresses, too."""
    with pytest.raises((InputError, SourceError)):
        resolve_address(parse_webhook_url(f"http://{host}/"))


def test_refused_places_are_told_and_written_down(client, admin, audit):
    answer = client.post(HOOKS, json={"url": "http://169.254.169.254/x"}, headers=admin)
    assert answer.status_code == 422
    assert answer.json()["error"] == "169.254.169.254 is not a place for alerts"
    assert audit()[0][1] == "add webhook"
    assert audit()[0][3].startswith("refused: ")


def test_there_are_not_too_many(client, admin):
    made = [
        client.post(HOOKS, json={"url": f"http://a/{n}"}, headers=admin).status_code
        for n in range(21)
    ]
    assert made == [201] * 20 + [409]


@pytest.mark.parametrize("key", ["robot", "kind", "level", "node", "topic"])
def test_another_alarm_is_news(key):
    repeats = DuplicateFilter()
    assert not repeats.is_duplicate(EVENT, 0)
    assert repeats.is_duplicate(EVENT, MINUTE - 1)
    assert not repeats.is_duplicate(EVENT | {key: "other"}, 1)
    assert not repeats.is_duplicate(EVENT, MINUTE)
    assert repeats.is_duplicate(EVENT, MINUTE + 1)


def test_alerts_outlive_a_failing_database(app, clock, monkeypatch, hook, tell, receiver):
    """Neither the look at the webhooks nor the note of a failure may end them."""
    monkeypatch.setattr(dispatcher, "RETRY_DELAYS_S", (0.0, 0.0, 0.0))
    hook()
    tell(id=1, topic="/a")
    assert number(receiver) == 1
    database = app.state.service.database
    with database.session() as session:
        session.execute(text("ALTER TABLE webhooks RENAME TO gone"))
    clock.sleep(10)
    receiver.answers = [500] * 4
    tell(id=2, topic="/b")
    assert [number(receiver) for _ in range(4)] == [2] * 4
    clock.sleep(10)
    tell(id=3, topic="/c")
    assert number(receiver) == 3
    with database.session() as session:
        session.execute(text("ALTER TABLE gone RENAME TO webhooks"))
    clock.sleep(10)
    tell(id=4, topic="/d")
    assert number(receiver) == 4
