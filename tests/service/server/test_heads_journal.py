"""The files of published heads are bounded, and what goes is proven by what stays."""

import errno
import json
import os
import resource

import pytest
from service_app import SIGNER
from sqlalchemy import delete, update
from store_data import make_verdict, new_robot, store_events

from rtron.service.server import heads_journal
from rtron.service.server.audit_check import check_audit_log
from rtron.service.server.heads_journal import HeadsJournal, heads_files
from rtron.service.store.chains import chain_heads
from rtron.service.store.tables import ChainLinkRow, ChainRow, EventRow

KEYS = {SIGNER.public_key}


@pytest.fixture
def world(database, tmp_path, monkeypatch):
    """Robots whose heads are published after each event, 1,000 bytes a file."""
    monkeypatch.setattr(heads_journal, "MAX_FILE_BYTES", 1000)

    class Published:
        def __init__(self):
            self.database, self.folder = database, tmp_path / "audit"
            self.folder.mkdir()
            self.journal = HeadsJournal(self.folder, database)
            self.ids = {name: new_robot(database, name) for name in ("car1", "car2")}
            self.number = 0

        def happen(self, robot="car1"):
            """Store an event, and publish all heads; tell whether a new file was begun."""
            self.number += 1
            store_events(database, self.ids[robot], [make_verdict(self.number)], robot=robot)
            rotated = self.journal.rotate()
            with database.session() as session:
                self.journal.append(SIGNER.sign_heads(self.number, chain_heads(session)))
            return rotated

        def rotate_times(self, times):
            while times:
                times -= self.happen()

        def report(self):
            return check_audit_log(database, heads_files(self.folder), KEYS)

        def size(self):
            return sum(path.stat().st_size for path in self.folder.iterdir())

    return Published()


def test_the_files_are_bounded_and_everything_stays_verifiable(world):
    world.happen("car2")
    sizes = []
    for _ in range(60):
        world.happen()
        sizes.append(world.size())
    assert max(sizes) < 3000
    assert sorted(path.name for path in world.folder.iterdir()) == ["heads.1.jsonl", "heads.jsonl"]
    first = json.loads((world.folder / "heads.1.jsonl").read_text().splitlines()[0])
    assert first["heads"].keys() == {"events:car1", "events:car2"}
    report = world.report()
    assert report.is_whole
    assert {chain.chain: chain.compared > 0 for chain in report.chains} == {
        "events:car1": True,
        "events:car2": True,
    }


@pytest.mark.parametrize("robot", ["car1", "car2"])
def test_what_is_older_than_every_file_is_still_proven(world, robot):
    world.happen("car2")
    world.rotate_times(3)
    with world.database.session() as session:
        chain = session.query(ChainRow).where(ChainRow.name == f"events:{robot}").one()
        first = session.get_one(ChainLinkRow, (chain.id, 1))
        event = session.get_one(EventRow, first.entry_id)
        event.reason = "nothing happened"
    assert not world.report().is_whole


def _rewrite(world):
    """Cut car1's chain off after its first entry, with its head."""
    with world.database.session() as session:
        chain = session.query(ChainRow).where(ChainRow.name == "events:car1").one()
        first = session.get_one(ChainLinkRow, (chain.id, 1))
        links = delete(ChainLinkRow).where(ChainLinkRow.chain_id == chain.id)
        session.execute(links.where(ChainLinkRow.number > 1))
        session.execute(delete(EventRow).where(EventRow.id > first.entry_id))
        session.execute(
            update(ChainRow).where(ChainRow.id == chain.id).values(number=1, hash=first.hash)
        )


def test_proof_of_a_change_is_not_forgotten(world, caplog):
    world.rotate_times(2)
    before = (world.folder / "heads.1.jsonl").read_bytes()
    _rewrite(world)
    for _ in range(30):
        assert not world.happen()
    assert (world.folder / "heads.1.jsonl").read_bytes() == before
    assert "grows: the log was changed" in caplog.text
    assert not world.report().is_whole


def test_replicas_with_one_folder_rotate_once(world):
    other = HeadsJournal(world.folder, world.database)
    world.happen()
    while (world.folder / "heads.jsonl").stat().st_size < heads_journal.MAX_FILE_BYTES:
        world.happen()
    assert [world.journal.rotate(), other.rotate()] == [True, False]


def test_a_full_disk_leaves_no_half_line(world):
    for _ in range(3):
        world.happen()
    before = (world.folder / "heads.jsonl").read_bytes()
    limits = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (len(before) + 20, limits[1]))
    try:
        with pytest.raises(OSError, match=os.strerror(errno.EFBIG)):
            world.journal.append(SIGNER.sign_heads(1, {}))
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert (world.folder / "heads.jsonl").read_bytes() == before
    assert world.report().is_whole


@pytest.mark.parametrize("half", [b"{", b'{"schema": "rtron.audit_heads/1", "hea', b"x" * 200_000])
def test_a_line_that_a_power_cut_has_cut_off_goes(world, half):
    world.happen()
    before = (world.folder / "heads.jsonl").read_bytes()
    (world.folder / "heads.jsonl").write_bytes(before + half)
    document = SIGNER.sign_heads(9, {})
    world.journal.append(document)
    text = (world.folder / "heads.jsonl").read_bytes()
    assert text == before + json.dumps(document).encode() + b"\n"


@pytest.mark.parametrize("line", ["", "{", "[]", '{"heads": 3}', "[" * 9999])
def test_a_line_that_a_crash_has_cut_off_does_not_hold_the_rest(world, line):
    world.rotate_times(1)
    with (world.folder / "heads.1.jsonl").open("a") as file:
        file.write(f"{line}\n")
    world.rotate_times(1)
    assert world.report().is_whole
