"""One service works on a database, whatever name it is given by."""

from contextlib import contextmanager

import pytest

from rtron.cli.main import main
from rtron.errors import InputError
from rtron.service.server.database_setup import hold_instance_lock
from rtron.service.store.database import Database


@contextmanager
def locked(path):
    Database(path).close()
    with hold_instance_lock(path):
        yield path


@pytest.fixture
def held(tmp_path):
    with locked(tmp_path / "rtron.db") as path:
        yield path


def refused(path):
    with pytest.raises(InputError) as raised, locked(path):
        pass
    return str(raised.value)


def test_a_symbolic_link_is_the_same_database(held, tmp_path):
    other = tmp_path / "other"
    other.mkdir()
    (other / "link.db").symlink_to(held)
    (tmp_path / "folder").symlink_to(tmp_path)
    for name in (other / "link.db", tmp_path / "folder" / "rtron.db", held):
        assert "another `rtron serve` works on this database" in refused(name)


def test_a_hard_link_is_refused_since_sqlite_takes_it_for_another_database(tmp_path):
    Database(tmp_path / "rtron.db").close()
    (tmp_path / "link.db").hardlink_to(tmp_path / "rtron.db")
    for name in ("rtron.db", "link.db"):
        assert "the database has another name" in refused(tmp_path / name)


def test_another_database_beside_it_is_free(held):
    with locked(held.with_name("second.db")) as second:
        assert second.is_file()


def test_a_second_service_leaves_the_schema_of_the_first_alone(tmp_path, monkeypatch, capsys):
    path = tmp_path / "rtron.db"
    with hold_instance_lock(path):
        path.touch()
        monkeypatch.setattr("sys.argv", ["rtron", "serve", "--database", str(path)])
        with pytest.raises(SystemExit) as ended:
            main()
    assert ended.value.code == 2
    assert "another `rtron serve` works on this database" in capsys.readouterr().err
    assert path.read_bytes() == b""


def test_a_url_names_the_same_file(held):
    with (
        pytest.raises(InputError, match="another `rtron serve`"),
        hold_instance_lock(f"sqlite:///{held}"),
    ):
        pass
