"""Reports of incidents on their way: made by a program, sent until the service has them."""

import asyncio
import shutil
import sys
from contextlib import contextmanager
from dataclasses import replace

import pytest
from cancelled_tasks import assert_ends_when_cancelled
from guarded_drive import FAST
from harness import wait_for
from incident_reports import a_report
from link_parts import Service, hello, options, running_relay, serving
from saved_incident import saved_incident

from rtron.guard.link import incident_reports, service_connection
from rtron.guard.link.incident_reports import MAX_BACKLOG, IncidentReports
from rtron.guard.system.state_folder import INCIDENTS
from rtron.vocabulary import Settings
from rtron.wire.common.incident_report import encode_report
from rtron.wire.common.link_protocol import (
    Hello,
    IncidentSaved,
    IncidentStored,
    NewSettings,
    decode_from_guard,
)

PROGRAM = (sys.executable, "-m", "rtron", "incident", "report")


def name(number):
    return f"20270115T080000.{number:03d}Z-stop-cmd_vel.mcap"


@pytest.fixture
def made(tmp_path):
    made = options(tmp_path)
    (made.state / INCIDENTS).mkdir()
    yield made
    shutil.rmtree(made.counter_folder, ignore_errors=True)


@pytest.fixture
def run():
    """Run a coroutine in one loop."""
    loop = asyncio.new_event_loop()
    yield loop.run_until_complete
    loop.close()


@pytest.fixture
def quick(monkeypatch):
    for module, pause in (
        (incident_reports, "_LOOK_S"),
        (incident_reports, "_ANSWER_S"),
        (service_connection, "_REPORT_PAUSE_S"),
    ):
        monkeypatch.setattr(module, pause, 0.05)


def writing(*reports):
    """Return a program that writes the report of each file that it is given."""
    known = {each.name: encode_report(each).decode() for each in reports}
    code = f"import sys; print({known!r}[sys.argv[1].rpartition('/')[2]])"
    return sys.executable, "-c", code


def save(made, *numbers):
    for number in numbers:
        (made.state / INCIDENTS / name(number)).touch()


def reported(made):
    file = made.reported_incidents_file
    return file.read_text().splitlines() if file.exists() else []


async def next_name(reports):
    """Return of which incident the next report is."""
    return decode_from_guard(await reports.next_message()).report.name


async def settled(reports, *confirmed):
    for each in confirmed:
        reports.confirm(each)
    await reports.settle()


def test_the_program_reports_a_real_incident(made, run):
    path = saved_incident(made.state / INCIDENTS, [0.1] * 20 + [FAST] * 20 + [None] * 60)
    reports = IncidentReports(replace(made, report_command=PROGRAM))
    report = decode_from_guard(run(reports.next_message())).report
    assert (report.name, report.size) == (path.name, path.stat().st_size)
    assert "1.00 m/s instead of 0.25 m/s" in report.alternatives[0].sentences[0]


def test_the_newest_comes_first_and_each_once(made, run, quick):
    save(made, 1, 2)
    made = replace(made, report_command=writing(a_report(name(1)), a_report(name(2))))
    reports = IncidentReports(made)
    assert run(next_name(reports)) == name(2)
    run(settled(reports, name(1), name(2)))
    assert run(next_name(reports)) == name(1)
    run(settled(reports, name(1)))
    assert reported(made) == [name(1), name(2)]
    assert IncidentReports(made)._find_next() is None


def test_what_is_not_answered_comes_again_and_is_given_up(made, run, quick):
    save(made, 1)
    made = replace(made, report_command=writing(a_report(name(1))))
    reports = IncidentReports(made)
    for _ in range(3):
        assert reported(made) == []
        assert run(next_name(reports)) == name(1)
        run(settled(reports))
    assert reported(made) == [name(1)]


@pytest.mark.parametrize(
    "command",
    [
        ("false",),
        ("true",),
        ("echo", "{}"),
        ("echo", "[" * 100_000),
        ("/no/such/program",),
        (sys.executable, "-c", "print('x' * 5_000_000)"),
    ],
    ids=["fails", "empty", "no report", "deep", "missing", "long"],
)
def test_what_gives_no_report_is_left_out(made, run, quick, caplog, command):
    save(made, 1, 2)
    run(until_reported(made, command, 2))
    assert f"{name(2)} is not reported" in caplog.text


def test_a_program_that_takes_too_long_is_ended(made, run, quick, monkeypatch, caplog):
    monkeypatch.setattr(incident_reports, "_REPORT_S", 0.1)
    save(made, 1)
    run(until_reported(made, (sys.executable, "-c", "import time; time.sleep(1000)"), 1))
    assert "takes more than" in caplog.text


async def until_reported(made, command, count):
    """Look for incidents until so many are done with."""
    reports = IncidentReports(replace(made, report_command=command))
    looking = asyncio.create_task(reports.next_message())
    await asyncio.to_thread(wait_for, lambda: len(reported(made)) == count)
    looking.cancel()
    await asyncio.gather(looking, return_exceptions=True)


def test_of_a_long_past_only_the_newest_are_reported(made):
    save(made, *range(MAX_BACKLOG + 5))
    reports = IncidentReports(replace(made, report_command=("true",)))
    assert reports._find_next() == name(MAX_BACKLOG + 4)
    assert reported(made) == [name(n) for n in range(5)]


def test_what_is_gone_is_forgotten(made):
    save(made, 1, 2)
    reports = IncidentReports(made)
    reports._note_reported([name(1)])
    (made.state / INCIDENTS / name(1)).unlink()
    reports._note_reported([name(2)])
    assert reported(made) == [name(2)]


class Archive(Service):
    """A service that takes reports of incidents."""

    takes = True

    def _hear(self, socket):
        for frame in socket:
            message = decode_from_guard(frame)
            self.heard.append(message)
            if isinstance(message, Hello):
                self.say(NewSettings(settings=Settings(), now=0, takes_incidents=self.takes))
            elif isinstance(message, IncidentSaved):
                self.say(IncidentStored(name=message.report.name))


@contextmanager
def relaying(made, service):
    """Run the link process for a guard that is there."""
    with running_relay(replace(made, service=service.url)) as relay:
        relay.call(relay._service.announce, hello())
        yield relay


def test_reports_go_to_a_service_that_takes_them(made, quick):
    save(made, 1, 2)
    made = replace(made, report_command=writing(a_report(name(1)), a_report(name(2))))
    with serving(Archive()) as service, relaying(made, service):
        wait_for(lambda: len(reported(made)) == 2, what="the reports")
    assert [each.report.name for each in service.of(IncidentSaved)] == [name(2), name(1)]


def test_a_service_of_before_gets_none(made):
    service = Archive()
    service.takes = False
    with serving(service), relaying(made, service) as relay:
        wait_for(lambda: relay._settings is not None, what="the settings")
        assert not relay._service._takes_incidents.is_set()


def test_reports_end_with_the_connection_even_as_the_service_confirms_one(made):
    """Who settles a report goes on to the next one: a lost end would keep both for ever."""
    current = []

    async def settle():
        current[:] = [IncidentReports(made)]
        while True:
            await current[0].settle()
            current[0]._is_stored.clear()

    def confirm(step):
        if step % 5 == 4:
            current[0]._is_stored.set()

    assert_ends_when_cancelled(settle, confirm)
