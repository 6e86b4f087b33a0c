"""The incident of a case: found by its topic and time, and told in simulated time."""

import pytest
from guarded_drive import FAST, posed_plan
from saved_incident import saved_incident

from rtron.demos.experiment import incident
from rtron.demos.experiment.incident import CaseIncident, in_simulated_time, wait_for_incident
from rtron.errors import SourceError
from rtron.sources.bag.incident import IncidentFile
from rtron.vocabulary import SECOND
from rtron.workflows.incidents import read_account


@pytest.fixture
def saved(tmp_path):
    """An incident in which the robot is 2.9 m from the kitchen, and asked for 1.5 m in 1.5 s."""
    folder = tmp_path / "rtron" / "drive" / "incidents"
    folder.mkdir(parents=True)
    plan = posed_plan(keep=60 * SECOND, after=60 * SECOND)
    return saved_incident(folder, [0.1] * 20 + [FAST] * 30 + [None] * 20, plan)


def test_it_is_found_by_its_topic_and_its_time(saved, tmp_path, monkeypatch):
    monkeypatch.setattr(incident, "_LIMIT", 0.1)
    caused = IncidentFile(saved).header.causes[-1].at / SECOND
    found = wait_for_incident(tmp_path, "/cmd_vel", caused, 3.0)
    assert found == CaseIncident(saved, "/cmd_vel", 3.0)
    for topic, since in (("/other", caused), ("/cmd_vel", caused + 1)):
        with pytest.raises(SourceError, match="the incident to be saved"):
            wait_for_incident(tmp_path, topic, since, 3.0)


@pytest.mark.parametrize(("speed", "enters"), [(1.0, False), (2.0, True)])
def test_a_fast_world_drives_farther_in_a_second_of_the_guards_clock(saved, speed, enters):
    sentence = CaseIncident(saved, "/cmd_vel", speed).sentence
    assert "1.00 m/s instead of 0.25 m/s" in sentence
    assert ("into kitchen after" in sentence) is enters


def test_all_that_is_drawn_is_in_simulated_time(saved):
    account = read_account(IncidentFile(saved))
    slow, fast = in_simulated_time(account, 1.0), in_simulated_time(account, 3.0)
    assert slow == account
    before, after = account.topics["/cmd_vel"], fast.topics["/cmd_vel"]
    assert times(after.output) == [3 * at for at in times(before.output)]
    assert times(after.commands["flow1"]) == [3 * at for at in times(before.commands["flow1"])]
    assert times(after.limits) == [3 * at for at in times(before.limits)]
    poses = [(3 * each.at, each.x) for each in account.poses["/pose"]]
    assert [(each.at, each.x) for each in fast.poses["/pose"]] == poses


def times(curve):
    return [at for at, *_ in curve]
