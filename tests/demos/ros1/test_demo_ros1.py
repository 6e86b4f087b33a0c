"""The case studies on a real ROS 1: harm without the guard, none with it, nothing left behind."""

import signal

import pytest
from demo_cases import EXPECTED, SEEDS, check_ending, facts, run_recorded_demo, run_study
from launched_demo import sums_by_flow

from rtron.demos.cases import AGENT, GR, MSR, RSR
from rtron.demos.cases import CASES as ALL_CASES
from rtron.demos.experiment.demonstration import are_as_expected
from rtron.demos.metrics.case_run import Variant

pytestmark = [pytest.mark.ros1, pytest.mark.long, pytest.mark.timeout(600)]
CASES = ("msr", "agent")


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return run_study(1, tmp_path_factory.mktemp("demo"), *CASES)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("case", CASES)
def test_the_attack_does_harm_without_the_guard_and_none_with_it(study, case, seed):
    assert facts(study, case, seed) == EXPECTED


def test_one_guarded_app_stands_against_all_cases_and_the_service_records_it(tmp_path):
    runs = run_recorded_demo(1, tmp_path / "demo")
    assert are_as_expected(runs)
    guarded = {run.case: run for run in runs if run.variant is Variant.GUARDED}
    assert {case: run.delivered for case, run in guarded.items()} == dict.fromkeys(ALL_CASES, 0)
    cases = (GR, RSR, MSR, AGENT)
    sums = {case.name: sums_by_flow(guarded[case.name].events, case.topic) for case in cases}
    assert sums["gr"]["unapproved"]["drop"] > 0
    assert sum(each["modify"] for each in sums["rsr"].values()) > 0
    assert sum(each["drop"] for each in sums["msr"].values()) > 0
    assert sums["agent"]["assistant"]["drop"] > 0


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ended_in_the_midst_it_leaves_no_process_behind(tmp_path, number):
    check_ending(1, tmp_path, number)
