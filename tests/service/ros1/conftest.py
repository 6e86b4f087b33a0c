"""A service process, and a person there."""

import time
from types import SimpleNamespace

import httpx
import pytest
from harness import LIMIT_S
from service_app import TLS, AccountFactory

from bench.service.service_process import ServiceProcess
from rtron.service.store.database import Database


@pytest.fixture
def service_with_person(tmp_path):
    """A service, and the HTTP client of ann, an end user."""
    with ServiceProcess(tmp_path) as service:
        database = Database(service.database)
        people = AccountFactory(SimpleNamespace(database=database, clock=time.time_ns))
        headers = people.session_headers("ann", "end_user")
        with httpx.Client(
            base_url=service.url, headers=headers, timeout=LIMIT_S, verify=TLS
        ) as person:
            yield service, person
        database.close()
