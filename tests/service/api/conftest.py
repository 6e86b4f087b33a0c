import subprocess

import httpx
import pytest
from service_app import AccountFactory, ManualClock, serve_in_thread

from rtron.service.config import ServiceConfig
from rtron.service.server.app import create_app


@pytest.fixture
def clock():
    return ManualClock()


@pytest.fixture
def app(tmp_path, clock):
    return create_app(ServiceConfig(database=tmp_path / "rtron.db"), clock)


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
    with httpx.Client(base_url=f"http://127.0.0.1:{port}", timeout=30) as client:
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
