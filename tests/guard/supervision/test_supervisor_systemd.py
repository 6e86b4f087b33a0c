"""What systemd hears of a real guard: signs of life only while the guard guards."""

import os
import signal

import pytest
from driven_base import CMD_VEL_GUARD, drive_plan, start_guard
from harness import wait_for
from systemd_socket import SystemdSocket

from rtron.vocabulary import GUARD_NODE

pytestmark = pytest.mark.ros1
ALIVE, SERVING = "WATCHDOG=1", "STATUS=guard serving"


@pytest.fixture
def systemd(ros1):
    with SystemdSocket(ros1.folder) as listening:
        ros1.environ |= listening.environment
        yield listening


def test_signs_of_life_stop_while_the_guard_stands_still(ros1, systemd):
    guard = start_guard(ros1, drive_plan(), CMD_VEL_GUARD)
    wait_for(lambda: systemd.has("READY=1"), what="READY")
    assert systemd.lines().index(SERVING) < systemd.lines().index(ALIVE)
    wait_for(lambda: systemd.lines().count(ALIVE) > 3, what="signs of life")
    ros1.wait_for_nodes(GUARD_NODE)
    since = len(systemd.lines())
    os.kill(ros1.ask(ros1.uri_of(GUARD_NODE), "getPid"), signal.SIGSTOP)
    wait_for(lambda: systemd.has("STATUS=guard stalled", since), what="the stall")
    wait_for(lambda: systemd.has(SERVING, since), what="the next guard")
    lines = systemd.lines()[since:]
    stalled = lines.index("STATUS=guard stalled")
    assert ALIVE not in lines[stalled : lines.index(SERVING, stalled)]
    assert "READY=1" not in lines
    guard.stop(signal.SIGTERM)
    assert guard.code == 0
    assert systemd.has("STOPPING=1", since)
