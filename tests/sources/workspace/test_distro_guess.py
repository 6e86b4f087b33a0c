"""A workspace's files tell its distribution; what only sounds like one does not."""

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
