"""Reports of incidents in the database: each once, the newest of each robot, and not for ever."""

from incident_reports import a_report, longest_report
from sqlalchemy import func, select
from store_data import new_robot

from rtron.service.store.incidents import (
    MAX_ROBOT_BYTES,
    MAX_ROBOT_INCIDENTS,
    IncidentRow,
    add_incident,
    find_incident,
    incident_page,
    prune_incidents,
)
from rtron.wire.common.incident_report import encode_report, report_document

MUCH = 1 << 40


def name(number):
    return f"20270115T080000.{number:03d}Z-stop-cmd_vel.mcap"


def add(database, robot, *reports, now=1):
    with database.session() as session:
        return [add_incident(session, robot, report, now) for report in reports]


def names(database, robot=None, before=None, limit=1000):
    with database.session() as session:
        return [each.name for each in incident_page(session, robot, before, limit).incidents]


def test_an_incident_is_in_the_list_and_whole(database):
    robot, report = new_robot(database, "car1"), a_report(causes=a_report().causes * 3)
    assert add(database, robot, report, now=7) == [True]
    with database.session() as session:
        (found,) = incident_page(session, "car1", None, 10).incidents
        whole = find_incident(session, "car1", report.name)
    assert (found.robot, found.name, found.stored, found.at) == ("car1", report.name, 7, report.at)
    assert (found.kind, found.topic, found.flow) == ("intervention", "/cmd_vel", "flow1")
    assert (found.owner, found.publisher, found.revision) == ("flow1", "/teleop", 3)
    assert found.causes == 3
    assert whole.report == report_document(report)


def test_the_first_report_of_a_name_stays(database):
    robot = new_robot(database, "car1")
    add(database, robot, a_report(reason="first"))
    assert add(database, robot, a_report(reason="second")) == [False]
    with database.session() as session:
        assert (
            find_incident(session, "car1", a_report().name).report["gravest"]["reason"] == "first"
        )


def test_robots_do_not_share_names(database):
    one, two = new_robot(database, "car1"), new_robot(database, "car2")
    assert [*add(database, one, a_report()), *add(database, two, a_report())] == [True, True]
    with database.session() as session:
        assert find_incident(session, "car3", a_report().name) is None
        assert [each.robot for each in incident_page(session, None, None, 9).incidents] == [
            "car2",
            "car1",
        ]
    assert names(database, "car3") == []


def test_pages_lead_to_the_oldest(database):
    robot, seen, before = new_robot(database, "car1"), [], None
    add(database, robot, *(a_report(name(n)) for n in range(5)))
    while True:
        with database.session() as session:
            page = incident_page(session, "car1", before, 2)
        seen += [each.name for each in page.incidents]
        before = page.next
        if before is None:
            break
    assert seen == [name(n) for n in reversed(range(5))]


def test_a_robot_keeps_its_newest_incidents(database):
    robot, other = new_robot(database, "car1"), new_robot(database, "car2")
    add(database, other, a_report())
    small = a_report(topics=(), alternatives=(), path=())
    for number in range(MAX_ROBOT_INCIDENTS + 3):
        add(database, robot, a_report(name(number), topics=(), alternatives=(), path=()))
    assert len(encode_report(small)) * MAX_ROBOT_INCIDENTS < MAX_ROBOT_BYTES
    kept = names(database, "car1")
    assert (len(kept), kept[-1]) == (MAX_ROBOT_INCIDENTS, name(3))
    assert len(names(database, "car2")) == 1


def test_a_robot_that_tells_much_keeps_few(database):
    robot = new_robot(database, "car1")
    for number in range(14):
        add(database, robot, longest_report(name(number)))
    with database.session() as session:
        used = session.scalar(select(func.sum(IncidentRow.bytes)))
    assert used <= MAX_ROBOT_BYTES
    assert names(database, "car1")[0] == name(13)
    assert len(names(database, "car1")) == MAX_ROBOT_BYTES // len(encode_report(longest_report()))


def test_what_is_too_old_goes(database):
    robot = new_robot(database, "car1")
    for now in (1, 2, 3):
        add(database, robot, a_report(name(now)), now=now)
    for cutoff, left in ((1, (3, 2, 1)), (2, (3, 2)), (4, ())):
        with database.session() as session:
            prune_incidents(session, cutoff, MUCH)
        assert names(database) == [name(n) for n in left]


def test_too_much_of_all_robots_takes_the_oldest(database):
    robots = [new_robot(database, f"car{n}") for n in range(3)]
    for number, robot in enumerate(robots):
        add(database, robot, a_report(name(number)))
    size = len(encode_report(a_report()))
    with database.session() as session:
        prune_incidents(session, 0, 2 * size)
    assert names(database) == [name(2), name(1)]
