"""Incidents over HTTP: the list of all robots and of one, and one incident whole."""

import pytest
from incident_reports import a_report
from store_data import new_robot

from rtron.service.store.incidents import add_incident
from rtron.wire.common.incident_report import report_document

NAMES = [f"20270115T08000{number}.000Z-stop-cmd_vel.mcap" for number in range(3)]


@pytest.fixture
def robots(app, clock):
    """Let car1 have told of two incidents, and car2 of one."""
    database = app.state.service.database
    for name, incidents in (("car1", NAMES[:2]), ("car2", NAMES[2:])):
        robot = new_robot(database, name)
        with database.session() as session:
            for incident in incidents:
                add_incident(session, robot, a_report(incident), clock())


@pytest.fixture
def get(client, people):
    headers = people.token_headers("reader", "read")

    def call(path, **query):
        return client.get(f"/api/v1{path}", headers=headers, params=query)

    return call


def test_the_list_has_cause_commander_and_revision(robots, get, clock):
    page = get("/incidents").json()
    assert [(each["robot"], each["name"]) for each in page["incidents"]] == [
        ("car2", NAMES[2]),
        ("car1", NAMES[1]),
        ("car1", NAMES[0]),
    ]
    assert page["next"] is None
    first = page["incidents"][0]
    assert (first["kind"], first["topic"], first["publisher"]) == (
        "intervention",
        "/cmd_vel",
        "/teleop",
    )
    assert (first["revision"], first["stored"], first["at"]) == (3, clock(), a_report().at)


def test_a_page_leads_to_the_next(robots, get):
    first = get("/incidents", limit=2).json()
    rest = get("/incidents", limit=2, before=first["next"]).json()
    assert [each["name"] for each in rest["incidents"]] == NAMES[:1]


def test_one_robot_has_its_own(robots, get):
    found = get("/incidents", robot="car1").json()["incidents"]
    assert [each["name"] for each in found] == [NAMES[1], NAMES[0]]
    assert get("/incidents", robot="nobody").json() == {"incidents": [], "next": None}


def test_an_incident_is_whole(robots, get, clock):
    found = get(f"/robots/car1/incidents/{NAMES[0]}").json()
    assert found["report"] == report_document(a_report(NAMES[0]))
    assert (found["robot"], found["stored"]) == ("car1", clock())


@pytest.mark.parametrize(
    "path", [f"car2/incidents/{NAMES[0]}", "car1/incidents/..%2fx", "x/incidents/y"]
)
def test_what_no_robot_has_told_of_is_404(robots, get, path):
    assert get(f"/robots/{path}").status_code == 404


@pytest.mark.parametrize(
    "query", [{"limit": 0}, {"limit": 201}, {"before": 0}, {"before": 1 << 63}]
)
def test_what_is_no_page_is_refused(robots, get, query):
    assert get("/incidents", **query).status_code == 422


def test_without_reports_the_list_is_empty(get):
    assert get("/incidents").json() == {"incidents": [], "next": None}
