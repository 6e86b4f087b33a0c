import sys
from types import ModuleType

import pytest

STARTED = ("small", "http://localhost:11311", "INFO", False, None, None)


@pytest.fixture
def started(monkeypatch):
    """Put a supervisor in place that only notes what it is told."""
    calls = []
    module = ModuleType("rtron.guard.supervision.start")

    def supervise(plan, master, *, log_level, dry_run, control, figures):
        calls.append((plan.app, master, log_level, dry_run, control, figures))
        sys.exit(0)

    module.supervise = supervise
    monkeypatch.setitem(sys.modules, "rtron.guard.supervision.start", module)
    return calls


def test_what_roslaunch_appends_is_accepted(rtron, plan_file, started):
    ran = rtron("guard", "--plan", plan_file, "__name:=rtron_guard", "__log:=/x.log")
    assert (ran.code, ran.out, ran.err) == (0, "", "")
    assert started == [STARTED]


def test_the_master_and_the_log_level_are_handed_on(rtron, plan_file, started):
    rtron("guard", "--plan", plan_file, "--master", "http://m:1", "--log-level", "debug")
    assert started == [("small", "http://m:1", "DEBUG", False, None, None)]


def test_a_dry_run_and_another_door_are_handed_on(rtron, plan_file, started, tmp_path):
    rtron("guard", "--plan", plan_file, "--dry-run", "--control", tmp_path / "door.sock")
    assert started[0][3:5] == (True, tmp_path / "door.sock")


def test_anything_else_is_2(rtron, plan_file, started, tmp_path):
    assert rtron("guard", "--plan", plan_file, "surplus").code == 2
    assert rtron("guard", "--plan", tmp_path / "none.yaml").code == 2
    assert rtron("guard").code == 2
    assert started == []
