"""What is loaded before the fork server is made: all that the guard's processes import later."""

import ast
import json
import os
import re
import subprocess
import sys
from functools import cache
from importlib.util import find_spec
from pathlib import Path

import pytest

import rtron
from rtron.guard.supervision.guard_config import GuardConfig
from rtron.guard.supervision.preload import _modules
from rtron.vocabulary import Plan

SOURCE = Path(rtron.__file__).parents[1]
PRELOAD = """
import json, sys
from rtron.guard.supervision.guard_config import GuardConfig
from rtron.guard.supervision.preload import preload
from rtron.vocabulary import Plan
import rtron.guard.supervision.supervisor_program
preload(GuardConfig(plan=Plan(app="a", ros={ros}), master="m", options={{"link": True}}))
print(json.dumps(sorted(name for name in sys.modules if name.startswith("rtron."))))
"""
MODULE = re.compile(r"rtron(\.\w+)+")
NOT_HERE = ("dry_run", "celled_", "verification", "figures")
"""What only a dry run, a cell and `rtron verify` load."""


def is_module(name):
    return (
        bool(MODULE.fullmatch(name))
        and SOURCE.joinpath(*name.split(".")).with_suffix(".py").exists()
    )


def lazy_imports(name):
    """Yield the modules that functions of a module import when they are called."""
    path = SOURCE.joinpath(*name.split("."))
    tree = ast.parse(
        (path / "__init__.py" if path.is_dir() else path.with_suffix(".py")).read_text()
    )
    functions = (each for each in ast.walk(tree) if isinstance(each, ast.FunctionDef))
    for node in (each for function in functions for each in ast.walk(function)):
        if isinstance(node, ast.ImportFrom) and node.module.startswith("rtron."):
            yield node.module
        if isinstance(node, ast.Constant) and is_module(str(node.value)):
            yield node.value


def guard_modules():
    for path in (SOURCE / "rtron" / "guard").rglob("*.py"):
        yield ".".join(path.relative_to(SOURCE).with_suffix("").parts)


@cache
def all_lazy_imports():
    return {each for name in guard_modules() for each in lazy_imports(name)}


@pytest.mark.parametrize("ros", [1, 2])
@pytest.mark.parametrize("options", [{}, {"link": True}, {"dry_run": True}], ids=str)
def test_what_is_loaded_before_is_what_is_imported_late(ros, options):
    plan = Plan(app="a", ros=ros, cell=("/n",))
    listed = {
        f"rtron.{each}" for each in _modules(GuardConfig(plan=plan, master="m", options=options))
    }
    assert {each for each in listed if not each.endswith("_program")} <= all_lazy_imports()
    assert all(map(is_module, listed))


@pytest.mark.parametrize("ros", [1, pytest.param(2, marks=pytest.mark.ros2)])
def test_nothing_is_imported_late_that_was_not_loaded_before(ros):
    if ros != 1 and find_spec("rclpy") is None:
        pytest.skip("needs ROS 2")
    ran = subprocess.run(
        [sys.executable, "-c", PRELOAD.format(ros=ros)],
        env=os.environ | {"PYTHONPATH": os.pathsep.join([str(SOURCE), *sys.path])},
        capture_output=True,
        text=True,
        check=True,
    )
    loaded = set(json.loads(ran.stdout))
    late = {each for name in loaded if ".guard." in name for each in lazy_imports(name)}
    missing = {each for each in late - loaded if not any(part in each for part in NOT_HERE)}
    assert {each for each in missing if ros != 1 or "ros2" not in each} == set()
