"""`rtron audit`, as somebody types it, on the database of a service that has run."""

import json
import shutil
import sys

import pytest
from service_app import AccountFactory, ManualClock
from sqlalchemy import text
from store_data import make_verdict, new_robot, store_events

from rtron.cli.main import main
from rtron.errors import InputError
from rtron.service.config import ServiceConfig
from rtron.service.domain.audit_events import AuditEvent
from rtron.service.domain.hash_chain import GENESIS
from rtron.service.server.app import create_app
from rtron.service.server.audit_key import HEADS_FILE, load_signer
from rtron.service.store.audit import record_event
from rtron.service.store.chain_check import all_chains
from rtron.service.store.chains import chain_heads


@pytest.fixture
def rtron(tmp_path, monkeypatch, capsys):
    """Run a command; return its exit code and what it has said."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))

    def run(*arguments):
        monkeypatch.setattr(sys, "argv", ["rtron", *map(str, arguments)])
        with pytest.raises(SystemExit) as ended:
            main()
        said = capsys.readouterr()
        return ended.value.code, said.out + said.err

    return run


@pytest.fixture
def database(tmp_path, where, monkeypatch):
    """Give the database of a service with its key; both kinds, each the default of the commands."""
    monkeypatch.setenv("RTRON_DATABASE", str(where))
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    app = create_app(ServiceConfig(database=where), ManualClock())
    AccountFactory(app.state.service).add_user("mary", "admin")
    database = app.state.service.database
    for number in range(3):
        with database.session() as session:
            record_event(session, number, AuditEvent(who="mary", action="login", target="mary"))
    store_events(
        database, new_robot(database, "car1"), [make_verdict(1), make_verdict(2)], robot="car1"
    )
    yield database
    database.close()


@pytest.fixture
def audit_dir(database, where, tmp_path):
    return tmp_path / "state/rtron/audit" if "://" in str(where) else tmp_path / "rtron.db.audit"


def change(database, statement):
    with database.session() as session:
        session.execute(text(statement))


def keep_heads(database, audit_dir, path):
    """Write the signed heads of now into a file, as a guard or a webhook has them."""
    with database.session() as session:
        heads = chain_heads(session)
    with path.open("a") as file:
        file.write(json.dumps(load_signer(audit_dir).sign_heads(1, heads)) + "\n")


def test_a_whole_log_is_whole_and_it_says_what_it_was_compared_with(rtron, database, audit_dir):
    code, said = rtron("audit", "verify")
    assert code == 0
    assert "whole: 2 chains with 5 entries, compared with 0 signed heads" in said
    assert "give --heads" in said
    keep_heads(database, audit_dir, audit_dir / HEADS_FILE)
    assert rtron("audit", "verify") == (
        0,
        "whole: 2 chains with 5 entries, compared with 2 signed heads\n",
    )


def test_a_change_is_said_and_is_a_finding(rtron, database):
    change(database, "UPDATE audit_log SET who = 'john' WHERE id = 2")
    code, said = rtron("audit", "verify")
    assert code == 1
    assert "service: entry 2 was changed, or is not where it was\nNOT whole:" in said


def test_what_is_found_steers_no_terminal(rtron, database):
    with database.session() as session:
        chain = next(each for each in all_chains(session) if each.name.startswith("events"))
        chain.name += "\x1b[2K\r\u202ewhole"
    code, said = rtron("audit", "verify")
    assert code == 1
    assert "events:car1\\x1b[2K\\r\\u202ewhole: entry 1 was changed" in said
    assert not {"\x1b", "\r", "\u202e"} & set(said)


def test_a_rewritten_log_is_found_with_heads_from_elsewhere(rtron, database, audit_dir, tmp_path):
    keep_heads(database, audit_dir, tmp_path / "car1.jsonl")
    for table in ("chain_links", "chains", "audit_log", "events"):
        change(database, f"DELETE FROM {table}")
    assert rtron("audit", "verify")[0] == 0
    code, said = rtron("audit", "verify", "--heads", "car1.jsonl")
    assert code == 1
    assert "the chain events:car1 is gone, but in a head of line 1 of car1.jsonl" in said


def test_heads_that_another_has_signed_are_none(rtron, database, audit_dir, tmp_path):
    keep_heads(database, tmp_path / "other", tmp_path / "forged.jsonl")
    code, said = rtron("audit", "verify", "--heads", "forged.jsonl")
    assert code == 1
    assert "line 1 of forged.jsonl: it is signed with another key" in said
    public = tmp_path / "other/public.pem"
    keys = ("--key", public, "--key", audit_dir / "public.pem")
    assert rtron("audit", "verify", "--heads", "forged.jsonl", *keys)[0] == 0


@pytest.mark.parametrize("line", ["", "[]", '"a"', "{", "[" * 100_000])
def test_a_file_that_is_no_json_lines_is_refused(rtron, database, tmp_path, line):
    (tmp_path / "odd.jsonl").write_text(f"{{}}\n{line}\n")
    code, said = rtron("audit", "verify", "--heads", "odd.jsonl")
    assert code == 2
    assert "line 2 is no JSON object" in said


def test_without_a_public_key_nothing_can_be_checked(rtron, database, audit_dir):
    shutil.rmtree(audit_dir)
    code, said = rtron("audit", "verify")
    assert code == 2
    assert "--key" in said


def test_an_export_is_checked_without_the_database(rtron, database, audit_dir, tmp_path):
    assert rtron("audit", "export", "-o", "log.jsonl") == (0, "")
    shutil.copy(audit_dir / "public.pem", tmp_path)
    shutil.rmtree(audit_dir)
    verify = ("audit", "verify", "log.jsonl", "--key", "public.pem", "--database", "none")
    assert rtron(*verify) == (0, "whole: 2 chains with 5 entries, compared with 2 signed heads\n")
    lines = (tmp_path / "log.jsonl").read_text().splitlines(keepends=True)
    assert [json.loads(line).get("schema", "") for line in lines] == [
        "rtron.audit_export/1",
        "",
        "",
        "rtron.audit_export/1",
        "",
        "",
        "",
        "rtron.audit_heads/1",
    ]
    for removed in range(len(lines)):
        (tmp_path / "log.jsonl").write_text("".join(lines[:removed] + lines[removed + 1 :]))
        assert rtron(*verify)[0] != 0, lines[removed]
    for cut in range(len(lines)):
        (tmp_path / "log.jsonl").write_text("".join(lines[:cut]))
        assert rtron(*verify)[0] == 1 or cut == 0, cut


def test_an_export_goes_to_the_terminal_too(rtron, database):
    code, said = rtron("audit", "export")
    assert code == 0
    assert len(said.splitlines()) == 8


def test_what_is_no_export_is_none(rtron, database, tmp_path):
    (tmp_path / "other.jsonl").write_text('{"a": 1}\n')
    assert rtron("audit", "verify", "other.jsonl")[0] == 2


def test_a_key_is_made_once_for_its_owner_alone(database, audit_dir):
    key = audit_dir / "key.pem"
    before = key.read_bytes()
    assert key.stat().st_mode & 0o777 == 0o600
    assert audit_dir.stat().st_mode & 0o777 == 0o700
    load_signer(audit_dir)
    assert key.read_bytes() == before
    assert sorted(each.name for each in audit_dir.iterdir()) == ["key.pem", "public.pem"]


def test_public_keys_in_the_folder_may_have_signed(rtron, database, audit_dir):
    before = load_signer(audit_dir)
    (audit_dir / "key.pem").unlink()
    (audit_dir / "public.pem").rename(audit_dir / "public-old.pem")
    assert load_signer(audit_dir).trusted_keys > before.trusted_keys
    with database.session() as session:
        chain = next(each for each in all_chains(session) if each.name == "events:car1")
        chain.anchor = before.sign_anchor(1, chain.name, GENESIS)
    assert rtron("audit", "verify")[0] == 0
    (audit_dir / "public-old.pem").unlink()
    code, said = rtron("audit", "verify")
    assert code == 1
    assert "events:car1: where it begins is not proven: it is signed with another key" in said


@pytest.mark.parametrize(
    ("name", "mode", "right_mode"),
    [("key.pem", 0o644, 600), ("key.pem", 0o602, 600), (".", 0o777, 700), (".", 0o702, 700)],
)
def test_a_key_that_everybody_may_read_or_replace_signs_nothing(
    rtron, database, audit_dir, name, mode, right_mode
):
    place = audit_dir / name
    place.chmod(mode)
    with pytest.raises(InputError, match="everybody may"):
        load_signer(audit_dir)
    code, said = rtron("audit", "export")
    assert code == 2
    assert f"chmod {right_mode} {place}" in said
    place.chmod(0o750 if name == "." else 0o440)
    assert load_signer(audit_dir)
