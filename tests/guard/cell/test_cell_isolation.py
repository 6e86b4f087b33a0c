"""A cell measures what it got, and refuses to be one that is open."""

import os
import shutil
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from celled_base import celled_plan, needs_cell, start_cell
from harness import wait_for

from rtron.guard.cell.access import SHARED_FOLDER
from rtron.guard.cell.isolation import (
    Gap,
    describe_outside,
    find_gaps,
    may_be_changed,
    process_users,
    take_unused_user,
    take_user,
)
from rtron.planning.plan_file.writer import write_plan

pytestmark = [pytest.mark.ros1, needs_cell]


def test_outside_a_cell_nothing_is_separate():
    assert set(find_gaps(describe_outside(), os.getuid())) == set(Gap)


def test_a_user_of_its_own_is_one_that_nobody_has(tmp_path):
    outside = describe_outside()
    user = take_unused_user("/base", outside, tmp_path)
    assert user not in outside.users
    assert Gap.SHARED_USER not in find_gaps(outside, user)


def test_cells_that_start_together_do_not_take_one_user(tmp_path):
    outside = describe_outside()
    assert len({take_unused_user("/base", outside, tmp_path) for _ in range(3)}) == 3


def test_a_cell_does_not_run_as_the_user_of_one_that_starts(open_ros1):
    SHARED_FOLDER.mkdir(mode=0o755, exist_ok=True)
    assert take_user(4323, SHARED_FOLDER)
    (open_ros1.folder / "rtron.yaml").write_text(write_plan(celled_plan()))
    cell = start_cell(open_ros1, ["true"], "--user", "4323")
    wait_for(lambda: cell.ended, what="the end of the cell")
    assert cell.code == 2
    assert "the user 4323 is that of another cell" in cell.log


@pytest.mark.parametrize("name", ["\u00b2", "4294967295", "99999999999999", "-1", "no-such-user"])
def test_a_user_that_there_cannot_be_is_refused(open_ros1, name):
    (open_ros1.folder / "rtron.yaml").write_text(write_plan(celled_plan()))
    cell = start_cell(open_ros1, ["true"], f"--user={name}")
    wait_for(lambda: cell.ended, what="the end of the cell")
    assert cell.code == 2
    assert f"there is no user {name}" in cell.log


@pytest.fixture
def program():
    with TemporaryDirectory(prefix="rtron-cell-test-") as folder:
        path = Path(folder) / "base"
        path.touch(mode=0o755)
        yield path


@pytest.mark.parametrize(
    ("part", "change"),
    [
        ("file", lambda path: path.chmod(0o775) or os.chown(path, 0, 4321)),
        ("file", lambda path: path.chmod(0o757)),
        ("file", lambda path: os.chown(path, 4321, 0)),
        ("folder", lambda path: os.chown(path, 4321, 0)),
        ("folder", lambda path: path.chmod(0o777)),
    ],
)
def test_a_program_that_others_may_change_is_known(program, part, change):
    link = program.with_name("link")
    link.symlink_to(program)
    assert not may_be_changed(link)
    change(program if part == "file" else program.parent)
    assert may_be_changed(link)


def test_who_may_change_what_root_starts_is_told(open_ros1):
    (open_ros1.folder / "rtron.yaml").write_text(write_plan(celled_plan()))
    cell = start_cell(open_ros1, ["true", open_ros1.folder / "rtron.yaml"])
    wait_for(lambda: cell.ended, what="the end of the cell")
    for name in ("rtron.yaml", "cell_driver.json"):
        assert f"{open_ros1.folder / name} may be changed by others than root" in cell.log
    assert "bin/true may be changed" not in cell.log


@pytest.mark.parametrize(
    ("option", "gap"), [("--net", "NETWORK"), ("--ipc", "SHARED_MEMORY"), ("--pid", "PROCESSES")]
)
def test_a_tool_that_does_not_do_what_it_should_is_noticed(open_ros1, option, gap):
    ros1 = open_ros1
    (ros1.folder / "rtron.yaml").write_text(write_plan(celled_plan()))
    tools = ros1.folder / "tools"
    tools.mkdir()
    words = f'for word do shift; [ "$word" = {option} ] || set -- "$@" "$word"; done'
    (tools / "unshare").write_text(f'#!/bin/sh\n{words}\nexec {shutil.which("unshare")} "$@"\n')
    (tools / "unshare").chmod(0o755)
    ros1.environ["PATH"] = f"{tools}:{ros1.environ['PATH']}"
    cell = start_cell(ros1, ["touch", ros1.folder / "begun"])
    wait_for(lambda: cell.ended, what="the end of the cell")
    assert cell.code == 2
    assert f"no cell: {gap}" in cell.log
    assert not (ros1.folder / "begun").exists()


def test_the_node_runs_as_a_user_of_its_own_without_groups(open_ros1):
    (open_ros1.folder / "rtron.yaml").write_text(write_plan(celled_plan()))
    cell = start_cell(open_ros1, ["sh", "-c", "echo user $(id -u) groups $(id -G)"])
    wait_for(lambda: cell.ended, what="the end of the cell")
    (words,) = [line.split() for line in cell.log.splitlines() if line.startswith("user ")]
    _, user, _, *groups = words
    assert int(user) not in process_users()
    assert groups == [user]
