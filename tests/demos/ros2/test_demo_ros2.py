"""The case studies on a real ROS 2: harm without the guard, none with it, nothing left behind."""

import signal

import pytest
from demo_cases import EXPECTED, SEEDS, check_ending, facts, run_study

pytestmark = [pytest.mark.ros2, pytest.mark.long, pytest.mark.timeout(600)]
CASES = ("gr",)


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    return run_study(2, tmp_path_factory.mktemp("demo"), *CASES)


@pytest.mark.parametrize("seed", SEEDS)
@pytest.mark.parametrize("case", CASES)
def test_the_attack_does_harm_without_the_guard_and_none_with_it(study, case, seed):
    assert facts(study, case, seed) == EXPECTED


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_ended_in_the_midst_it_leaves_no_process_behind(tmp_path, number):
    check_ending(2, tmp_path, number)
