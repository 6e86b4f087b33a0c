"""What systemd hears, over a real socket of its kind."""

import os
import socket

import pytest
from systemd_socket import SystemdSocket

from rtron.vocabulary import SECOND
from rtron.wire.common.systemd import SystemdNotifier, take_notifier


@pytest.fixture
def systemd(tmp_path):
    with SystemdSocket(tmp_path) as listening:
        yield listening


def test_a_service_is_ready_once_and_alive_twice_a_period(systemd):
    notifier = SystemdNotifier(systemd.environment["NOTIFY_SOCKET"], 2 * SECOND)
    notifier.report(0, "starting", is_well=False)
    assert systemd.lines() == ["STATUS=starting"]
    for now in (SECOND, 2 * SECOND - 1, 2 * SECOND):
        notifier.report(now, "serving", is_well=True)
    notifier.report(9 * SECOND, "stalled", is_well=False)
    notifier.stopping()
    assert systemd.lines()[1:] == [
        "STATUS=serving",
        "READY=1",
        "WATCHDOG=1",
        "WATCHDOG=1",
        "STATUS=stalled",
        "STOPPING=1",
    ]


def test_an_abstract_address_begins_with_an_at_sign():
    name = f"rtron-test-{os.getpid()}"
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as listening:
        listening.bind(f"\0{name}")
        SystemdNotifier(f"@{name}", 0).stopping()
        assert listening.recv(100, socket.MSG_DONTWAIT) == b"STOPPING=1"


def test_a_report_without_room_does_not_wait_and_is_sent_again(systemd, caplog):
    notifier = SystemdNotifier(systemd.environment["NOTIFY_SOCKET"], 0)
    while not caplog.records:
        notifier.stopping()
    notifier.report(0, "serving", is_well=True)
    sent = systemd.lines()
    assert "READY=1" not in sent
    notifier.report(1, "serving", is_well=True)
    assert systemd.lines()[-2:] == ["STATUS=serving", "READY=1"]
    assert len(caplog.records) == 1


def test_the_environment_is_taken_so_that_children_do_not_report(systemd):
    environment = systemd.environment | {"WATCHDOG_PID": str(os.getpid()), "HOME": "/"}
    take_notifier(environment).report(0, "serving", is_well=True)
    assert systemd.lines() == ["STATUS=serving", "READY=1", "WATCHDOG=1"]
    assert environment == {"HOME": "/"}


@pytest.mark.parametrize(
    "change", [{"WATCHDOG_PID": "1"}, {"WATCHDOG_USEC": "soon"}, {"WATCHDOG_USEC": ""}]
)
def test_a_watchdog_of_another_process_gets_no_signs_of_life(systemd, change):
    take_notifier(systemd.environment | change).report(0, "serving", is_well=True)
    assert systemd.lines() == ["STATUS=serving", "READY=1"]


@pytest.mark.parametrize(("address", "logged"), [("", 0), ("vsock:2:1", 1), ("/nowhere/to", 1)])
def test_without_a_socket_nothing_fails(address, logged, caplog):
    notifier = take_notifier({"NOTIFY_SOCKET": address})
    notifier.report(0, "serving", is_well=True)
    notifier.report(1, "serving", is_well=True)
    assert len(caplog.records) == logged
