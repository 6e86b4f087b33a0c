"""The whole API against its own description, with what a hypothesis makes of it."""

import pytest
import schemathesis
from hypothesis import HealthCheck, given, settings
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_schema_conformance,
    status_code_conformance,
)
from site_of_tests import People, served

from rtron.service.app import create_app
from rtron.service.config import Config

CHECKS = (
    not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_schema_conformance,
)


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    app = create_app(Config(database=tmp_path_factory.mktemp("fuzz") / "rtron.db"))
    people = People(app.state.service)
    headers = people.token("fuzz", "admin", "developer", "end_user")
    with served(app) as port:
        yield f"http://127.0.0.1:{port}", headers


def test_the_api_does_what_it_says(site):
    url, headers = site
    schema = schemathesis.openapi.from_url(f"{url}/openapi.json")
    operations = [found.ok() for found in schema.get_all_operations()]
    assert len(operations) > 30
    for operation in operations:
        tried(operation, url, headers)


def tried(operation, url, headers):
    @settings(
        max_examples=12, deadline=None, suppress_health_check=list(HealthCheck), database=None
    )
    @given(case=operation.as_strategy())
    def holds(case):
        case.call_and_validate(base_url=url, headers=headers, checks=CHECKS, timeout=30)

    holds()
