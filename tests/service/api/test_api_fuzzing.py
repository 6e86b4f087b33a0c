"""The whole API against its own description, with what a hypothesis makes of it."""

import time

import pytest
import schemathesis
from controller_setup import PLAN
from hypothesis import HealthCheck, given, settings
from incident_reports import a_report
from schemathesis import GenerationMode
from schemathesis.checks import not_a_server_error
from schemathesis.specs.openapi.checks import (
    content_type_conformance,
    response_schema_conformance,
    status_code_conformance,
)
from service_app import AccountFactory, serve_in_thread

from rtron.planning import parse_plan
from rtron.service.config import ServiceConfig
from rtron.service.server.app import create_app
from rtron.service.store.incidents import add_incident
from rtron.service.store.robots import find_robot
from rtron.wire.common.link_protocol import Hello

CHECKS = (
    not_a_server_error,
    status_code_conformance,
    content_type_conformance,
    response_schema_conformance,
)


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    app = create_app(ServiceConfig(database=tmp_path_factory.mktemp("fuzz") / "rtron.db"))
    met = Hello(app="small", plan=parse_plan(PLAN), run="run", began=1, version="1", robot="car1")
    app.state.service.controller.handle_hello("car1", met)
    database = app.state.service.database
    with database.session() as session:
        add_incident(session, find_robot(session, "car1")[0].id, a_report(), time.time_ns())
    people = AccountFactory(app.state.service)
    headers = people.token_headers("fuzz", "admin", "developer", "end_user")
    with serve_in_thread(app) as port:
        yield f"http://127.0.0.1:{port}", headers


@pytest.mark.parametrize("mode", GenerationMode)
def test_the_api_does_what_it_says(site, mode):
    url, headers = site
    schema = schemathesis.openapi.from_url(f"{url}/openapi.json")
    operations = [found.ok() for found in schema.get_all_operations()]
    assert len(operations) > 30
    for operation in operations:
        if mode is GenerationMode.POSITIVE or operation.body or operation.query:
            tried(operation.as_strategy(generation_mode=mode), url, headers)


def tried(cases, url, headers):
    @settings(max_examples=8, deadline=None, suppress_health_check=list(HealthCheck), database=None)
    @given(case=cases)
    def holds(case):
        if "robot" in case.path_parameters:
            case.path_parameters["robot"] = "car1"
        if "node" in case.path_parameters:
            case.path_parameters["node"] = "speed"
        if "incident" in case.path_parameters:
            case.path_parameters["incident"] = a_report().name
        case.call_and_validate(base_url=url, headers=headers, checks=CHECKS, timeout=60)

    holds()
