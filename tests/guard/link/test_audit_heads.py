import json
import shutil

import pytest
from harness import wait_for
from link_parts import Service, hello, options, running_relay, serving

from rtron.guard.core.event_loop import EventLoop
from rtron.guard.link import audit_heads
from rtron.guard.link.audit_heads import HeadsFile
from rtron.guard.link.link_client import LinkClient
from rtron.vocabulary import GuardState
from rtron.wire.common.link_protocol import AuditHeads, Hello, StateReport


def heads(number, hash="a" * 64, chain="service"):
    return {"schema": "rtron.audit_heads/1", "heads": {chain: [number, hash]}}


@pytest.fixture
def path(tmp_path):
    return tmp_path / "audit_heads.jsonl"


def numbers(path):
    return [json.loads(line)["heads"]["service"][0] for line in path.read_text().splitlines()]


def test_heads_are_kept_in_their_order_for_the_guards_user_alone(path):
    for number in (1, 2):
        HeadsFile(path).add(heads(number))
    assert numbers(path) == [1, 2]
    assert path.stat().st_mode & 0o777 == 0o600


def test_the_first_and_the_last_ones_are_kept_and_some_between(path, monkeypatch):
    monkeypatch.setattr(audit_heads, "MAX_LINES", 10)
    file = HeadsFile(path)
    for number in range(1, 24):
        file.add(heads(number))
        kept = numbers(path)
        assert len(kept) <= 10
        assert kept == sorted(kept)
        assert kept[0] == 1
        assert kept[-5:] == list(range(max(1, number - 4), number + 1))
    HeadsFile(path).add(heads(24))
    assert 5 < len(numbers(path)) <= 10


def test_a_flood_of_heads_drives_none_out(path, monkeypatch, caplog):
    monkeypatch.setattr(audit_heads, "MAX_LINES", 1000)
    now = [0.0]
    file = HeadsFile(path, lambda: now[0])
    for number in range(1, 5001):
        file.add(heads(number))
    assert numbers(path) == list(range(1, audit_heads.MAX_BURST + 1))
    file.add(heads(3))
    assert "went from 5000 to 3 entries" in caplog.text
    now[0] += audit_heads.INTERVAL_S
    for number in (5001, 5002):
        file.add(heads(number))
    assert numbers(path)[-1] == 5001


@pytest.mark.parametrize(("number", "hash"), [(4, "a" * 64), (5, "b" * 64)])
def test_a_log_that_goes_back_or_is_another_is_said(path, caplog, number, hash):
    HeadsFile(path).add(heads(5))
    HeadsFile(path).add(heads(5))
    assert caplog.text == ""
    HeadsFile(path).add(heads(number, hash))
    assert f"was changed: service went from 5 to {number} entries" in caplog.text
    assert numbers(path) == [5, 5, number]


@pytest.mark.parametrize(
    ("count", "shown"),
    [(0, []), (1, [1]), (2, [2, 1]), (100, [100, 37, 1]), (2000, [2000, 1937, 977, 1])],
)
def test_some_of_them_are_shown_to_the_service_old_ones_too(path, count, shown):
    path.write_text("".join(json.dumps(heads(n + 1)) + "\n" for n in range(count)))
    samples = HeadsFile(path).samples()
    assert [each["heads"]["service"][0] for each in samples] == shown
    path.write_text("[]\n")
    assert HeadsFile(path).samples() == ()


def test_what_is_too_long_is_not_kept(path, caplog):
    HeadsFile(path).add(heads(1, "a" * 5000))
    assert "not kept" in caplog.text
    assert not path.exists()


def test_a_full_disk_loses_heads_and_nothing_else(path, caplog):
    file = HeadsFile(path)
    path.mkdir()
    file.add(heads(1))
    assert "not kept" in caplog.text


@pytest.mark.parametrize(
    "line", ["", "{", "[]", '{"heads": 3}', '{"heads": {"a": [1]}}', "[" * 9999]
)
def test_an_odd_line_in_the_file_harms_nothing(path, line):
    path.write_text(f"{line}\n")
    HeadsFile(path).add(heads(1))
    assert len(path.read_text().splitlines()) == 2


@pytest.mark.parametrize("odd", [None, 3, {"a": 1}, {"a": [1]}, {"a": ["x", "y"]}])
def test_odd_heads_harm_nothing(path, odd):
    HeadsFile(path).add({"heads": odd})
    assert json.loads(path.read_text()) == {"heads": odd}


def test_the_link_process_keeps_what_the_service_sends(tmp_path):
    with serving(Service()) as service:
        made, loop = options(tmp_path, service.url), EventLoop()
        settings = []
        line = LinkClient(
            loop,
            made.address,
            hello,
            lambda: StateReport(state=GuardState(at=1, revision=0)),
            settings.append,
        )
        line.open()
        with running_relay(made):
            wait_for(lambda: loop.step(0.01) or service.of(Hello), what="the hello")
            assert service.of(Hello)[0].takes_audit_heads
            assert service.of(Hello)[0].held_heads == ()
            service.say(AuditHeads(document=heads(7)))
            wait_for(made.audit_heads_file.exists, what="the file")
            service.say(AuditHeads(document=heads(8)))
            wait_for(lambda: numbers(made.audit_heads_file) == [7, 8], what="the second line")
            assert service.socket.protocol.close_code is None
            service.socket.close()
            wait_for(lambda: loop.step(0.01) or len(service.of(Hello)) > 1, what="the next hello")
            assert service.of(Hello)[1].held_heads == (heads(8), heads(7))
        line.close()
        loop.close()
        shutil.rmtree(made.counter_folder, ignore_errors=True)
    assert settings == []
