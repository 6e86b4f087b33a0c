"""What tests of the security service use: real databases of both kinds."""

import pytest
from argon2 import PasswordHasher
from postgresql_server import PostgreSQL, programs

from rtron.service.store.accounts import passwords
from rtron.service.store.database import Database

_FULL = passwords._hasher


@pytest.fixture(scope="session", autouse=True)
def cheap_password_hashing():
    """Let a password cost little here: many log in, and each would take a quarter of a second."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(passwords, "_hasher", PasswordHasher(1, 64, 1))
        passwords._dummy_hash.cache_clear()
        yield
    passwords._dummy_hash.cache_clear()


@pytest.fixture
def real_password_hashing(monkeypatch):
    """Let a password cost what it costs in service."""
    monkeypatch.setattr(passwords, "_hasher", _FULL)
    passwords._dummy_hash.cache_clear()
    yield
    passwords._dummy_hash.cache_clear()


@pytest.fixture(scope="session")
def postgresql():
    """Run a PostgreSQL server of our own until the end."""
    if programs() is None:
        pytest.skip("Debian's postgresql is not installed: make setup")
    server = PostgreSQL()
    yield server
    server.stop()


@pytest.fixture(params=["sqlite", "postgresql"])
def where(request, tmp_path):
    """Give the place of a new, empty database of each kind."""
    if request.param == "sqlite":
        return tmp_path / "rtron.db"
    return request.getfixturevalue("postgresql").new_database()


@pytest.fixture
def database(where):
    """Give a new database of each kind."""
    opened = Database(where)
    yield opened
    opened.close()
