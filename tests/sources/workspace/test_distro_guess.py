"""A workspace's files tell its distribution; what only sounds like one does not."""

import os
import subprocess

import pytest

from rtron.sources.workspace.distro_guess import guess_distro


def guessed(folder, ros=2):
    found = guess_distro([folder], ros)
    return found and found.name


def on_branch(folder, name):
    (folder / ".git").mkdir()
    (folder / ".git" / "HEAD").write_text(f"ref: refs/heads/{name}\n")


@pytest.mark.parametrize(
    ("branch", "name"),
    [
        ("jazzy", "jazzy"),
        ("humble-devel", "humble"),
        ("ros2/kilted", "kilted"),
        ("fix/rolling-window", None),
        ("fix/iron-out", None),
        ("ironing", None),
        ("noetic-devel", None),
        ("main", None),
    ],
)
def test_a_branch_counts_that_is_named_after_a_distribution(tmp_path, branch, name):
    on_branch(tmp_path, branch)
    assert guessed(tmp_path) == name


def git(folder, *arguments):
    who = {"GIT_AUTHOR_NAME": "a", "GIT_AUTHOR_EMAIL": "a@b", "GIT_CONFIG_GLOBAL": os.devnull}
    who |= {"GIT_COMMITTER_NAME": "a", "GIT_COMMITTER_EMAIL": "a@b", "GIT_CONFIG_NOSYSTEM": "1"}
    subprocess.run(["git", *arguments], cwd=folder, env=os.environ | who, check=True)


def test_a_worktree_has_a_branch_of_its_own(tmp_path):
    main, other = tmp_path / "main", tmp_path / "other"
    main.mkdir()
    git(main, "init", "--quiet", "--initial-branch=humble")
    git(main, "commit", "--quiet", "--allow-empty", "--message=a")
    git(main, "worktree", "add", "--quiet", "-b", "jazzy", str(other))
    (other / "src").mkdir()
    assert (guessed(main), guessed(other)) == ("humble", "jazzy")
    assert guess_distro([other / "src"], 2).file == "other/.git"


@pytest.mark.parametrize(
    "text", ["gitdir: nowhere", "gitdir: .", "gitdir: .git\n", "", "\0", "jazzy"]
)
def test_a_git_file_that_leads_nowhere_tells_nothing(tmp_path, text):
    (tmp_path / ".git").write_text(text)
    assert guessed(tmp_path) is None


def test_a_branch_tells_more_surely_than_a_list_of_repositories(tmp_path):
    (tmp_path / "robot.repos").write_text("version: humble\n")
    assert guessed(tmp_path) == "humble"
    on_branch(tmp_path, "jazzy")
    assert guessed(tmp_path) == "jazzy"


def test_most_files_count_and_the_later_of_two(tmp_path):
    folder = tmp_path / ".github" / "workflows"
    folder.mkdir(parents=True)
    (folder / "a.yml").write_text("ros: [humble, jazzy]\n")
    assert guessed(tmp_path) == "jazzy"
    (folder / "b.yml").write_text("ros: humble\n")
    assert guessed(tmp_path) == "humble"


def test_a_manifest_counts_in_its_conditions_only(tmp_path):
    manifest = tmp_path / "package.xml"
    manifest.write_text("<package><description>iron humble</description></package>")
    assert guessed(tmp_path) is None
    manifest.write_text(
        """<package><depend condition="$ROS_DISTRO == 'iron'">x</depend></package>"""
    )
    assert guessed(tmp_path) == "iron"


def test_the_name_of_a_list_of_repositories_tells_the_distribution(tmp_path):
    text = "repositories: {a: {version: humble}}"
    (tmp_path / "robot.repos").write_text(text)
    assert guessed(tmp_path) == "humble"
    (tmp_path / "robot.repos").rename(tmp_path / "robot.jazzy.repos")
    assert guessed(tmp_path) == "jazzy"
    assert guess_distro([tmp_path], 1) is None
