"""`rtron bridge check` and `rtron bridge token` on the command line."""

import pytest
from bridge_parts import PLAN, RIGHTS, SET_BOOL

from rtron.bridge.rights.rights_file import parse_rights
from rtron.bridge.rights.tokens import SignIn, token_hash


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rtron.yaml").write_text(PLAN.format(ros=1))
    text = RIGHTS.format(token=token_hash("a"), other=token_hash("b"))
    (tmp_path / "bridge.yaml").write_text(text)
    return tmp_path


@pytest.fixture
def std_srvs(tmp_path, monkeypatch):
    """A package with the service type of the rights, as ROS 1 finds it."""
    package = tmp_path / "ros" / "std_srvs"
    (package / "srv").mkdir(parents=True)
    (package / "package.xml").write_text("<package><name>std_srvs</name></package>")
    (package / "srv" / "SetBool.srv").write_text(SET_BOOL)
    monkeypatch.setenv("ROS_PACKAGE_PATH", str(tmp_path / "ros"))


def test_types_that_nobody_knows_are_named(rtron, folder, monkeypatch):
    monkeypatch.setenv("ROS_PACKAGE_PATH", "")
    rights = (folder / "bridge.yaml").read_text()
    (folder / "bridge.yaml").write_text(rights.replace("nav_msgs/Odometry", "my_msgs/Pose"))
    ran = rtron("bridge", "check")
    assert ran.code == 0
    assert "no problem" not in ran.out
    assert "  web: /odom: the type my_msgs/Pose is not known here\n" in ran.out
    assert "  web: /lamp: the srv type std_srvs/SetBool is not installed here\n" in ran.out
    assert "/cmd_vel" not in ran.out


@pytest.mark.usefixtures("std_srvs")
def test_rights_that_are_right(rtron, folder):
    ran = rtron("bridge", "check")
    assert (ran.code, ran.out) == (0, "bridge.yaml: 2 clients, no problem\n")


def test_rights_that_the_plan_does_not_give(rtron, folder):
    unguarded = (folder / "rtron.yaml").read_text().replace("/bridge/web", "/other")
    (folder / "rtron.yaml").write_text(unguarded)
    for words in (("bridge", "check"), ("bridge", "--port", "0")):
        ran = rtron(*words)
        assert ran.code == 2
        assert "web: the plan guards /cmd_vel and has no flow of /bridge/web" in ran.err


@pytest.mark.parametrize("name", ["rtron.yaml", "bridge.yaml"])
def test_a_file_that_is_missing(rtron, folder, name):
    (folder / name).unlink()
    ran = rtron("bridge", "check")
    assert ran.code == 2
    assert name in ran.err


def test_a_token_is_shown_once_and_its_entry_signs_it_in(rtron):
    ran = rtron("bridge", "token", "tablet")
    assert ran.code == 0
    secret = next(line.strip() for line in ran.out.splitlines() if "rtb_" in line)
    entry = ran.out.rpartition("\n\n")[2]
    (client,) = parse_rights(f"schema: rtron.bridge/1\nclients:\n{entry}").clients
    assert SignIn([client]).find_client(secret) is client


@pytest.mark.parametrize("name", ["Tablet", "a b", "", "../a"])
def test_what_is_no_name(rtron, name):
    ran = rtron("bridge", "token", name)
    assert ran.code == 2
    assert "is no name of a client" in ran.err


def test_the_help_says_how_to_begin(rtron):
    for words in (("bridge", "-h"), ("bridge", "check", "-h"), ("bridge", "token", "-h")):
        ran = rtron(*words)
        assert ran.code == 0
        assert f"$ rtron {' '.join(words[:-1])}" in ran.out
