"""Code that seems to publish what nobody is known to publish."""

from dataclasses import replace

import pytest
from file_tree import package
from notation import graph_of

from cpu_time import growth
from rtron.sources.static.common import node_sources, unread_publishers
from rtron.sources.static.common.unread_publishers import with_unread_publishers
from rtron.sources.workspace import Workspace
from rtron.vocabulary import Evidence

BASE = "/base robot own\n    sub /arm/cmd_vel geometry_msgs/Twist\n"
SENDS = 'self.pub = factory("cmd_vel")\nself.pub.publish(t)\n'


@pytest.fixture
def notes(tmp_path):
    """Return the places of what a graph's packages, with one file, may publish."""

    def find(code, text=BASE, name="robot", file="gui.py"):
        folder = package(tmp_path / name, {file: code})
        graph = with_unread_publishers(
            graph_of("app", text, ros=1), Workspace({name: folder}, [tmp_path])
        )
        assert {fact.kind for fact in graph.wiring} <= {"unread_publisher"}
        return [
            (fact.subject, place.file.removeprefix(f"{folder}/"), place.line)
            for fact in graph.wiring
            for place in fact.evidence
        ]

    return find


@pytest.mark.parametrize(
    "code",
    [
        SENDS,
        "pub = nh.advertise<T>('~/cmd_vel', 1);",
        "topics = {'x': '/arm/cmd_vel'}\n\nmake_publisher(topics)\n",
        "x.PUBLISH(\n\n'cmd_vel')\n",
    ],
)
def test_a_text_that_ends_with_the_name_beside_a_publisher(notes, code):
    line = code[: code.index("cmd_vel")].count("\n") + 1
    assert notes(code) == [("/arm/cmd_vel", "gui.py", line)]


@pytest.mark.parametrize(
    "code",
    [
        "sub = factory('cmd_vel')\nsub.read()\n",
        "pub = factory('my_cmd_vel')\npub.publish(t)\n",
        "pub = factory('cmd_vel_raw')\npub.publish(t)\n",
        "cmd_vel.publish(t)\n",
        "x = 'cmd_vel'\n\n\n\ny.publish(t)\n",
        "",
    ],
)
def test_another_text_is_none(notes, code):
    assert notes(code) == []


def test_the_place_of_an_endpoint_that_was_read_is_none(tmp_path):
    folder = package(tmp_path / "robot", {"gui.py": SENDS})
    graph, workspace = graph_of("app", BASE, ros=1), Workspace({"robot": folder}, [tmp_path])
    assert with_unread_publishers(graph, workspace).wiring
    place = Evidence(file=str(folder / "gui.py"), line=1)
    ends = tuple(replace(end, evidence=(place,)) for end in graph.endpoints)
    assert not with_unread_publishers(replace(graph, endpoints=ends), workspace).wiring


def test_a_publisher_that_was_read_does_not_make_one_of_a_name_beside_it(tmp_path):
    code = "rospy.init_node('cmd_vel')\n\nout = rospy.Publisher('imu', Imu)\n"
    folder = package(tmp_path / "robot", {"imu.py": code})
    graph, workspace = graph_of("app", BASE, ros=1), Workspace({"robot": folder}, [tmp_path])
    assert with_unread_publishers(graph, workspace).wiring
    place = Evidence(file=str(folder / "imu.py"), line=3)
    ends = tuple(replace(end, evidence=(place,)) for end in graph.endpoints)
    assert not with_unread_publishers(replace(graph, endpoints=ends), workspace).wiring


@pytest.mark.parametrize(
    "text",
    [
        BASE + "/nav robot own\n    pub /arm/cmd_vel geometry_msgs/Twist\n",
        BASE.replace("sub", "pub"),
        BASE.replace("cmd_vel", "{}"),
        BASE.replace("robot", "other"),
    ],
)
def test_nothing_is_noted_where_nothing_is_missing_or_the_package_has_no_node(notes, text):
    assert notes(SENDS, text) == []


def test_short_names_stand_everywhere(notes):
    assert notes("p.publish('go')", BASE.replace("cmd_vel", "go")) == []
    assert notes("p.publish('run')", BASE.replace("cmd_vel", "run"))


@pytest.mark.parametrize("file", ["data.yaml", "gui.pyc", "README.md"])
def test_only_code_is_searched(notes, file):
    assert notes(SENDS, file=file) == []


@pytest.mark.parametrize("file", ["test/gui.py", "src/tests/gui.py"])
def test_tests_are_no_part_of_the_app(notes, file):
    assert notes(SENDS, file=file) == []


@pytest.mark.parametrize(
    "main", ["if __name__ == '__main__':\n    run()\n", "int main(int argc, char** argv) {}\n"]
)
def test_a_program_that_is_not_started_publishes_nothing(notes, main):
    assert notes(SENDS + main) == []


def test_a_program_that_is_started_may_publish(tmp_path):
    script = "#!/usr/bin/env python3\n" + SENDS + "if __name__ == '__main__':\n    run()\n"
    folder = package(tmp_path / "robot", {"gui.py": script})
    graph = graph_of("app", BASE, ros=1)
    started = replace(graph, nodes=tuple(replace(n, executable="gui.py") for n in graph.nodes))
    workspace = Workspace({"robot": folder}, [tmp_path])
    assert with_unread_publishers(started, workspace).wiring


def test_a_file_that_is_too_large_is_left_out(notes, monkeypatch):
    monkeypatch.setattr(node_sources, "MAX_FILE_BYTES", len(SENDS) - 1)
    assert notes(SENDS) == []


def test_no_more_files_than_most_are_searched(notes, monkeypatch):
    monkeypatch.setattr(unread_publishers, "MAX_FILES", 0)
    assert notes(SENDS) == []


def test_a_link_out_of_the_package_is_not_followed(tmp_path):
    (tmp_path / "secret.py").write_text(SENDS)
    folder = package(tmp_path / "src" / "robot", {})
    (folder / "gui.py").symlink_to(tmp_path / "secret.py")
    workspace = Workspace({"robot": folder}, [tmp_path / "src"])
    assert not with_unread_publishers(graph_of("app", BASE, ros=1), workspace).wiring


def test_the_name_of_a_call_that_was_read_may_stand_on_one_of_its_lines(tmp_path):
    code = "self.sub = self.create_subscription(\n    Twist,\n    'cmd_vel',\n)\npub.publish(t)\n"
    folder = package(tmp_path / "robot", {"reader.py": code})
    graph, workspace = graph_of("app", BASE, ros=1), Workspace({"robot": folder}, [tmp_path])
    place = Evidence(file=str(folder / "reader.py"), line=1)
    ends = tuple(replace(end, evidence=(place,)) for end in graph.endpoints)
    assert not with_unread_publishers(replace(graph, endpoints=ends), workspace).wiring


def test_a_workspace_may_lie_below_a_folder_of_tests(tmp_path):
    folder = package(tmp_path / "tests" / "robot", {"gui.py": SENDS})
    workspace = Workspace({"robot": folder}, [tmp_path])
    assert with_unread_publishers(graph_of("app", BASE, ros=1), workspace).wiring


def test_a_name_that_no_file_can_have_is_searched_for_all_the_same(notes):
    assert notes(SENDS, BASE.replace("cmd_vel", "\ud800cmd")) == []


def test_the_time_of_a_hostile_file_grows_with_its_size(tmp_path):
    """Eight times the size takes about eight times as long, where its square takes 64."""
    graph = graph_of("app", BASE, ros=1)
    workspaces = []
    for size in (25_000, 200_000):
        code = "publish" + '"cmd_vel" ' * (size // 10)
        folder = package(tmp_path / str(size), {"gui.py": code})
        workspaces.append(Workspace({"robot": folder}, [tmp_path]))
    assert growth(lambda workspace: with_unread_publishers(graph, workspace), *workspaces) < 32
