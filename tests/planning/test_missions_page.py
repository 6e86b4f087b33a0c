"""What docs/missions.md shows is a plan that can be used."""

import re
from pathlib import Path

import pytest

from rtron.planning.app_check import check_plan
from rtron.planning.missions import MISSIONS, mission_summary, mission_text
from rtron.planning.plan_file.loader import parse_plan
from rtron.planning.plan_file.writer import write_plan

PAGE = Path(__file__).parents[2] / "docs" / "missions.md"
BLOCKS = re.findall(r"```yaml\n(.*?)```", PAGE.read_text(encoding="utf-8"), re.DOTALL)


def test_the_page_has_examples():
    assert len(BLOCKS) == 2


@pytest.mark.parametrize("block", BLOCKS)
def test_each_example_of_the_page_is_a_plan_without_problems(block):
    assert check_plan(parse_plan(f"app: page\n{block}")) == ()


@pytest.mark.parametrize("name", MISSIONS)
def test_each_mission_is_a_plan_without_problems_that_writes_as_it_reads(name):
    plan = parse_plan(mission_text(name))
    assert plan.app == name
    assert check_plan(plan) == ()
    assert parse_plan(write_plan(plan)) == plan
    assert mission_summary(name).endswith(".")
