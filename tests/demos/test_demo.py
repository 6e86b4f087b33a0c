"""The demo as `make demo` runs it: the attack succeeds, the app is guarded, the attack fails."""

import json

import pytest

from rtron.demos.ros1 import run

pytestmark = [pytest.mark.ros1, pytest.mark.timeout(240)]


def test_the_attack_succeeds_without_the_guard_and_fails_with_it(tmp_path):
    assert run(tmp_path) == 0
    risks = json.loads((tmp_path / "risks.json").read_text())
    assert "GR-ST:/cmd_vel" in {risk["id"] for risk in risks["risks"]}
    assert "flow1" in (tmp_path / "rtron.yaml").read_text()
    assert "rtron_guard" in (tmp_path / "guarded.launch").read_text()
