"""What tests of the security service use: real databases of both kinds, the app, its people."""

import subprocess
from functools import partial

import authlib.deprecate  # noqa: F401 - it shows its warnings always, unless pytest's filters come later
import httpx
import pytest
from argon2 import PasswordHasher
from postgresql_server import PostgreSQL, programs
from service_app import TLS, AccountFactory, ManualClock, open_app, serve_in_thread
from sqlalchemy import create_engine
from sqlalchemy.engine.default import DefaultDialect

from rtron.service.config import ServiceConfig
from rtron.service.store import database as store_database
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


@pytest.fixture(scope="session", autouse=True)
def shared_statements():
    """Compile a statement once for all databases of a kind; SQLAlchemy does so for each of them."""
    sharing = partial(create_engine, execution_options={"compiled_cache": {}})
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(store_database, "create_engine", sharing)
        patch.setattr(DefaultDialect, "__eq__", lambda ours, other: ours.name == other.name)
        patch.setattr(DefaultDialect, "__hash__", lambda ours: hash(ours.name))
        yield


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
def where(request):
    """Give the place of a new database of each kind."""
    if request.param == "sqlite":
        return request.getfixturevalue("database_file")
    return request.getfixturevalue("postgresql").new_database()


@pytest.fixture(params=["sqlite", "postgresql"])
def empty_place(request, tmp_path):
    """Give the place of a database of each kind that has no tables yet."""
    if request.param == "sqlite":
        return tmp_path / "empty.db"
    return request.getfixturevalue("postgresql").empty_database()


@pytest.fixture
def database(where):
    """Give a new database of each kind."""
    opened = Database(where)
    yield opened
    opened.close()


@pytest.fixture
def clock():
    return ManualClock()


@pytest.fixture
def monotonic(clock):
    """The clock that nobody sets; it is the other one in tests that set none."""
    return clock


@pytest.fixture
def app(database_file, clock, monotonic):
    with open_app(ServiceConfig(database=database_file), clock, monotonic) as app:
        yield app


@pytest.fixture
def people(app):
    return AccountFactory(app.state.service)


@pytest.fixture
def port(app):
    with serve_in_thread(app) as port:
        yield port


@pytest.fixture
def client(port):
    """A program without cookies and tokens."""
    with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=60, verify=TLS) as client:
        yield client


@pytest.fixture
def admin(people):
    """The headers of an admin's browser."""
    return people.session_headers("root", "admin", "developer", "end_user")


@pytest.fixture
def audit(client, admin):
    """Read the audit log: who did what to what, and the outcome; newest first."""

    def read():
        entries = client.get("/api/v1/audit", headers=admin).json()["entries"]
        return [(each["who"], each["action"], each["target"], each["outcome"]) for each in entries]

    return read


@pytest.fixture
def certificate(tmp_path):
    """Make a certificate for localhost that nobody trusts, and its key."""
    cert, key = tmp_path / "cert.pem", tmp_path / "key.pem"
    command = ["openssl", "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:P-256"]
    command += ["-nodes", "-days", "2", "-subj", "/CN=localhost", "-keyout", key, "-out", cert]
    command += ["-addext", "subjectAltName=DNS:localhost,IP:127.0.0.1"]
    subprocess.run(command, check=True, capture_output=True)
    return cert, key
