"""The plan that docs/tutorial.md shows can be used as it stands, and so can its launch file."""

import ast
import re
from pathlib import Path

from rtron.planning.plan_file.loader import parse_plan
from rtron.vocabulary import PolicyName
from rtron.workflows.check_plan import check

PAGE = (Path(__file__).parents[2] / "docs" / "tutorial.md").read_text(encoding="utf-8")


def blocks(language):
    return re.findall(rf"```{language}\n(.*?)```", PAGE, re.DOTALL)


def test_the_plan_of_the_tutorial_is_a_plan_without_problems():
    (block,) = blocks("yaml")
    plan = parse_plan(f"app: page\n{block}")
    assert check(plan) == ()
    assert plan.rsrcn.policy is PolicyName.SAFE_CONSTRAIN
    assert [rule.name for rule in plan.msrcn.rules] == ["keep_off_the_stairs", "battery"]


def test_the_launch_file_of_the_tutorial_is_python():
    (block,) = blocks("python")
    assert "generate_launch_description" in {
        node.name for node in ast.walk(ast.parse(block)) if isinstance(node, ast.FunctionDef)
    }
