"""Signed heads go into a file, to webhooks and to guards, and find a log that was rewritten."""

import asyncio
import json
from contextlib import closing
from dataclasses import replace

import httpx
import pytest
from harness import wait_for
from link_parts import event, hello, options, running_relay
from service_app import SIGNER, AccountFactory, serve_in_thread
from sqlalchemy import update
from store_data import make_verdict, new_robot, store_events

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.link.link_client import LinkClient
from rtron.service.config import ServiceConfig
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.hash_chain import (
    GENESIS,
    HEADS_SCHEMA,
    heads_of,
    next_head,
    verify_document,
)
from rtron.service.live.hub import Hub
from rtron.service.server.app import create_app
from rtron.service.server.audit_check import check_audit_log
from rtron.service.server.heads_journal import HeadPublisher, HeadsJournal
from rtron.service.store.audit import record_event
from rtron.service.store.chain_check import all_chains, chain_links
from rtron.service.store.database import Database
from rtron.service.store.tables import AuditRow, ChainLinkRow
from rtron.vocabulary import GuardState
from rtron.wire.common.link_protocol import StateReport


@pytest.fixture
def published(database, clock, tmp_path):
    """A publisher with a guard that is connected; what it has sent where."""

    class Published:
        def __init__(self):
            self.hub, self.file = Hub(), tmp_path / "heads.jsonl"
            self.webhook, self.guard = [], []
            self.publisher = HeadPublisher(
                database,
                self.hub,
                SIGNER,
                clock,
                journal=HeadsJournal(tmp_path, database),
                interval_s=3600,
                on_heads=self._on_heads,
            )
            self.signer, self.database = SIGNER, database

        async def _on_heads(self, document):
            self.webhook.append(document)

        def connect(self, robot):
            self.hub.register(robot, self, dry_run=False)

        def send_heads(self, document):
            self.guard.append(document)

        def push(self, settings):
            raise AssertionError(settings)

        def publish(self):
            asyncio.run(self.publisher.publish())

        def lines(self):
            return [json.loads(line) for line in self.file.read_text().splitlines()]

    return Published()


def names(document, keys):
    return sorted(heads_of(verify_document(document, keys, HEADS_SCHEMA)))


def test_what_has_changed_goes_into_the_file_signed(published, clock):
    for name in ("car1", "car2"):
        store_events(
            published.database, new_robot(published.database, name), [make_verdict(1)], robot=name
        )
    published.publish()
    published.publish()
    store_events(published.database, 1, [make_verdict(2)], robot="car1")
    clock.sleep(1)
    published.publish()
    first, second = published.lines()
    keys = {published.signer.public_key}
    assert names(first, keys) == ["events:car1", "events:car2"]
    assert names(second, keys) == ["events:car1"]
    assert second["at"] == clock.now
    assert published.webhook == [first, second]


def test_a_guard_gets_the_heads_of_its_robot_and_of_the_service_once(published):
    for name in ("car1", "car2"):
        store_events(
            published.database, new_robot(published.database, name), [make_verdict(1)], robot=name
        )
    published.publish()
    assert published.guard == []
    published.connect("car2")
    published.publish()
    published.publish()
    (document,) = published.guard
    assert names(document, {published.signer.public_key}) == ["events:car2"]


def test_what_could_not_be_written_is_published_the_next_time(published):
    store_events(published.database, new_robot(published.database), [make_verdict(1)])
    published.file.mkdir()
    published.publish()
    assert published.webhook == []
    published.file.rmdir()
    published.publish()
    assert len(published.lines()) == len(published.webhook) == 1


def test_the_file_may_be_moved_away(published):
    robot = new_robot(published.database)
    for number in (1, 2):
        store_events(published.database, robot, [make_verdict(number)])
        published.publish()
        published.file.rename(published.file.with_suffix(f".{number}"))
    assert not published.file.exists()


def test_what_changes_is_published_at_the_end_too(app, people):
    with serve_in_thread(app):
        people.add_user("mary", "admin")
        with app.state.service.database.session() as session:
            record_event(session, 1, AuditEvent(who="mary", action="login", target="mary"))
    (line,) = (app.state.service.config.audit_folder / "heads.jsonl").read_text().splitlines()
    assert json.loads(line)["heads"]["service"][0] == 1


def test_a_guard_that_keeps_heads_finds_a_log_that_was_rewritten_whole(tmp_path, clock):
    config = ServiceConfig(database=tmp_path / "rtron.db", heads_interval_s=1)
    app = create_app(config, clock)
    people = AccountFactory(app.state.service)
    headers = people.token_headers("r1", "guard", robot="r1")
    with serve_in_thread(app) as port:
        made = options(tmp_path, f"http://127.0.0.1:{port}")
        made.token_file.write_text(headers["Authorization"].split()[1])
        loop = EventLoop()
        line = LinkClient(loop, made.address, hello, _state, lambda _settings: None)
        line.open()
        with running_relay(made):
            line.queue_event(event(1))
            wait_for(lambda: loop.step(0.01) or made.audit_heads_file.exists(), what="heads")
        line.close()
        loop.close()
    keys = {app.state.service.signer.public_key}
    with closing(Database(config.database)) as database:
        _rewrite(database, "guard:r1", "nobody")
    _reconnect_and_see_the_alarm(config, clock, made)
    database = Database(config.database)
    assert check_audit_log(database, [], keys).is_whole
    report = check_audit_log(database, [made.audit_heads_file], keys)
    database.close()
    assert not report.is_whole
    (chain,) = [each for each in report.chains if each.faults]
    assert (chain.chain, chain.compared > 0) == ("robot:r1", True)


def _reconnect_and_see_the_alarm(config, clock, made):
    """Let the guard come back to the service: people see at once that the log was rewritten."""
    app = create_app(config, clock)
    reader = AccountFactory(app.state.service).token_headers("reader", "read", "admin")
    with (
        serve_in_thread(app) as port,
        httpx.Client(base_url=f"http://127.0.0.1:{port}/api/v1", headers=reader) as client,
    ):
        made, loop = replace(made, service=f"http://127.0.0.1:{port}"), EventLoop()
        line = LinkClient(loop, made.address, hello, _state, lambda _settings: None)
        line.open()
        with running_relay(made):
            wait_for(lambda: loop.step(0.01) or client.get("/robots/r1").json()["alarms"])
            (alarm,) = client.get("/robots/r1").json()["alarms"]
        line.close()
        loop.close()
        assert alarm["kind"] == "audit log"
        assert "the service's log was changed: in robot:r1 entry " in alarm["reason"]
        query = {"robot": "r1", "kind": "alarm"}
        (event,) = client.get("/events", params=query).json()["events"]
        assert (event["level"], event["reason"]) == ("error", alarm["reason"])
        lines = client.get("/audit", params={"limit": 200}).json()["entries"]
        (line,) = [each for each in lines if each["action"] == "heads"]
        assert (line["who"], line["outcome"][:8]) == ("guard:r1", "refused:")


def _state():
    return StateReport(state=GuardState(at=1, revision=0))


def _rewrite(database, who, other):
    """Change who did something, and compute all hashes again."""
    with database.session() as session:
        session.execute(update(AuditRow).where(AuditRow.who == who).values(who=other))
        for chain in all_chains(session):
            head = GENESIS
            for link in list(chain_links(session, chain)):
                head = next_head(chain.name, head, link.content)
                session.get(ChainLinkRow, (chain.id, link.number)).hash = head.hash
            chain.hash = head.hash
