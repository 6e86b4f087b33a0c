import logging
import sys
from types import ModuleType

import pytest

STARTED = ("small", "http://localhost:11311", False, None)


@pytest.fixture
def guarded(monkeypatch):
    """Put a guard in place that only notes how it was started."""
    calls = []
    module = ModuleType("rtron.guard.run")

    def run_guard(plan, master_uri, *, dry_run, control):
        calls.append((plan.app, master_uri, dry_run, control))
        return 0

    module.run_guard = run_guard
    monkeypatch.setitem(sys.modules, "rtron.guard.run", module)
    monkeypatch.setattr(logging, "basicConfig", lambda **keys: calls.append(keys["level"]))
    return calls


def test_what_roslaunch_appends_is_accepted(rtron, plan_file, guarded):
    ran = rtron("guard", "--plan", plan_file, "__name:=rtron_guard", "__log:=/x.log")
    assert (ran.code, ran.out, ran.err) == (0, "", "")
    assert guarded == ["INFO", STARTED]


def test_the_master_and_the_log_level_are_handed_on(rtron, plan_file, guarded):
    rtron("guard", "--plan", plan_file, "--master", "http://m:1", "--log-level", "debug")
    assert guarded == ["DEBUG", ("small", "http://m:1", False, None)]


def test_a_dry_run_and_another_door_are_handed_on(rtron, plan_file, guarded, tmp_path):
    rtron("guard", "--plan", plan_file, "--dry-run", "--control", tmp_path / "door.sock")
    assert guarded[1][2:] == (True, tmp_path / "door.sock")


def test_anything_else_is_2(rtron, plan_file, guarded, tmp_path):
    assert rtron("guard", "--plan", plan_file, "surplus").code == 2
    assert rtron("guard", "--plan", tmp_path / "none.yaml").code == 2
    assert rtron("guard").code == 2
    assert STARTED not in guarded
