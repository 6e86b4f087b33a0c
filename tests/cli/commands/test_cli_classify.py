import json
import os
import re
from pathlib import Path
from types import SimpleNamespace

import pytest

from rtron.cli.commands.explain_function import _complete

REPOS = [
    {"repo": "indoor_localization", "packages": [{"name": "indoor_localization"}]},
    {"repo": "zzz", "packages": [{"name": "zzz"}]},
    {"repo": "joystick_teleop"},
]
DATA = Path(os.environ.get("RTRON_DATA", "")) / "corpus"


@pytest.fixture
def corpus(tmp_path):
    path = tmp_path / "corpus.jsonl"
    path.write_text("\n".join(map(json.dumps, REPOS)))
    return path


@pytest.fixture
def folder(tmp_path):
    path = tmp_path / "grid_mapping"
    path.mkdir()
    text = "<package><name>grid_mapping</name><description>Builds a map.</description></package>"
    (path / "package.xml").write_text(text)
    return path


def documents(text):
    return [json.loads(row) for row in text.splitlines()]


def test_a_line_for_each_repository(rtron, corpus):
    ran = rtron("classify", corpus)
    assert (ran.code, ran.err) == (0, "")
    found, unknown, teleop = documents(ran.out)
    assert set(found) == {
        "repo",
        "functions",
        "primary",
        "confidence",
        "probabilities",
        "decided_by",
        "evidence",
    }
    assert found["confidence"] == found["probabilities"]["Localization"]
    assert 0.5 < found["confidence"] < 1
    assert (found["repo"], found["primary"]) == ("indoor_localization", "Localization")
    assert found["decided_by"] == "name"
    evidence = found["evidence"][0]
    assert set(evidence) == {"piece", "rule", "type", "text", "package"}
    assert "localization" in evidence["text"]
    assert (unknown["functions"], unknown["primary"]) == (["Extension"], "Extension")
    assert unknown["probabilities"] == {"Extension": unknown["confidence"]}
    assert unknown["confidence"] < 0.5
    assert unknown["decided_by"] == "none"
    assert teleop["functions"] == ["Teleoperation"]


def test_a_folder(rtron, folder):
    (found,) = documents(rtron("classify", folder).out)
    assert (found["repo"], found["primary"]) == ("grid_mapping", "Mapping")


def test_the_code_in_a_folder_decides_where_words_do_not(rtron, tmp_path):
    path = tmp_path / "zzz"
    path.mkdir()
    (path / "package.xml").write_text("<package><name>zzz</name></package>")
    (unknown,) = documents(rtron("classify", path).out)
    assert unknown["decided_by"] == "none"
    (path / "node.py").write_text(
        "from geometry_msgs.msg import Twist\nfrom sensor_msgs.msg import Joy\n"
        "rospy.Publisher('cmd_vel', Twist)\nrospy.Subscriber('joy', Joy, drive)\n"
    )
    (found,) = documents(rtron("classify", path).out)
    assert (found["primary"], found["decided_by"]) == ("Teleoperation", "code")
    (evidence,) = found["evidence"]
    text = "subscribes sensor_msgs/Joy, publishes geometry_msgs/Twist"
    assert (evidence["piece"], evidence["text"]) == ("code", text)
    assert f"code “{text}”" in " ".join(rtron("explain-function", path).out.split())


def test_a_distribution(rtron, tmp_path):
    path = tmp_path / "distribution.yaml"
    path.write_text("repositories: {joystick_teleop: {release: {url: x}}, zzz: {}}")
    decided, unknown = documents(rtron("classify", path).out)
    assert (decided["primary"], decided["decided_by"]) == ("Teleoperation", "name")
    assert unknown["decided_by"] == "none"


def test_readmes_tell_where_nothing_else_does(rtron, corpus, tmp_path):
    readmes = tmp_path / "readmes.jsonl"
    text = "This package estimates the pose of the robot: localization with a particle filter."
    readmes.write_text(json.dumps({"repo": "zzz", "readme": text}))
    found = documents(rtron("classify", corpus, "--readmes", readmes).out)[1]
    assert (found["primary"], found["decided_by"]) == ("Localization", "readme")


def test_tables_instead(rtron, corpus, tmp_path):
    ran = rtron("classify", corpus, "--table")
    assert ran.code == 0
    assert ran.out.startswith("3 repositories, 2 decided (66.7 %)\n")
    path = tmp_path / "tables.txt"
    assert rtron("classify", corpus, "--table", "-o", path).out == ""
    assert path.read_text().splitlines()[:45] == ran.out.splitlines()[:45]


def test_a_file_gets_the_lines(rtron, corpus, tmp_path):
    path = tmp_path / "classes.jsonl"
    ran = rtron("classify", corpus, "-o", path)
    assert (ran.code, ran.out) == (0, "")
    assert len(documents(path.read_text())) == 3


def test_what_is_left_out_is_told(rtron, corpus):
    corpus.write_text("\n".join(["{", '{"repo": "joystick_teleop"}', *["\x1b["] * 11]))
    ran = rtron("classify", corpus)
    assert (ran.code, len(documents(ran.out))) == (0, 1)
    rows = ran.err.splitlines()
    assert rows[0].startswith(f"left out: {corpus}:1: not JSON: ")
    assert rows[10:] == ["left out: 2 more"]


def test_an_item_that_fails_is_told(rtron, corpus, monkeypatch):
    def failing(_):
        raise ValueError("x")

    monkeypatch.setattr("rtron.workflows.function_graph.classify", failing)
    ran = rtron("classify", corpus)
    assert (ran.code, ran.out) == (0, "")
    assert ran.err.splitlines()[1] == "left out: zzz: ValueError: x"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["classify", "absent.jsonl"], "absent.jsonl: No such file or directory"),
        (["classify", "absent"], "absent: No such file or directory"),
        (["classify", "/dev/null"], "no repository could be read"),
        (["explain-function", "absent"], "'absent' is no folder"),
        (["explain-function", "x", "--from", "absent.jsonl"], "No such file or directory"),
    ],
)
def test_bad_input_is_2(rtron, words, said):
    ran = rtron(*words)
    assert (ran.code, ran.out) == (2, "")
    assert said in ran.err


def test_the_evidence_of_a_folder(rtron, folder):
    ran = rtron("explain-function", folder)
    assert (ran.code, ran.err) == (0, "")
    head = r"grid_mapping  1 package\nMapping, decided by the name, \d\d % sure\n"
    assert re.match(head, ran.out)
    assert "\npackage grid_mapping\n" in ran.out


def test_the_evidence_of_a_repository_in_a_file(rtron, corpus):
    head = r"joystick_teleop  0 packages\nTeleoperation, decided by the name, \d\d % sure\n"
    assert re.match(head, rtron("explain-function", "joystick_teleop", "--from", corpus).out)
    ran = rtron("explain-function", "joystick_telop", "--from", corpus)
    assert ran.code == 2
    assert "did you mean joystick_teleop?" in ran.err
    assert "`rtron classify` lists them all" in rtron("explain-function", "q", "--from", corpus).err


def test_a_folder_of_several_names_them(rtron, folder):
    (folder.parent / "b").mkdir()
    (folder.parent / "b/package.xml").write_text("<package><name>b</name></package>")
    ran = rtron("explain-function", folder.parent)
    assert ran.code == 2
    rows = ran.err.splitlines()
    assert rows[0].endswith("holds 2 repositories: b, grid_mapping")
    assert rows[1] == f"help: rtron explain-function --from {folder.parent} NAME"


@pytest.mark.parametrize(
    ("number", "said"), [(5, ": r0, r1, r2, r3, r4"), (6, ": r0, r1, r2, r3, r4, …")]
)
def test_of_many_repositories_the_first_five_are_named(rtron, tmp_path, number, said):
    for name in range(number):
        (tmp_path / f"r{name}").mkdir()
        (tmp_path / f"r{name}/package.xml").write_text("<package><name>a</name></package>")
    ran = rtron("explain-function", tmp_path)
    assert ran.err.splitlines()[0].endswith(f"holds {number} repositories{said}")


def test_a_package_is_found_in_its_repository(rtron, tmp_path):
    path = tmp_path / "corpus.jsonl"
    lines = [
        {"repo": "first", "packages": [{"name": "amcl"}, {"name": "shared"}]},
        {"repo": "second", "packages": [{"name": "shared"}, {"name": "first"}]},
    ]
    path.write_text("\n".join(map(json.dumps, lines)))
    for name, home in (("amcl", "first"), ("shared", "first"), ("first", "first")):
        ran = rtron("explain-function", "--from", path, name)
        assert (ran.code, ran.out.split()[0]) == (0, home)
        assert ran.err == (f"{name} is a package of {home}\n" if name != home else "")


OFFERED = ["a-b.c_1+d@e", "größe"]
HOSTILE = ["am$(touch x);id", "a b", "a'b", "`b`", "a\nb", "a\\b", "*", "~", "a|b", "\x1b[2J", "/a"]


def test_a_shell_completes_names_after_the_file(rtron, corpus, monkeypatch):
    monkeypatch.setenv("_RTRON_COMPLETE", "complete_bash")
    monkeypatch.setenv("COMP_WORDS", f"rtron explain-function --from {corpus} jo")
    monkeypatch.setenv("COMP_CWORD", "4")
    assert rtron().out == "joystick_teleop\n"


def test_names_are_completed(corpus):
    said = SimpleNamespace(params={"source": str(corpus)})
    assert _complete(said, "jo") == ["joystick_teleop"]
    corpus.write_text("\n".join(json.dumps({"repo": name}) for name in (*OFFERED, *HOSTILE)))
    assert _complete(said, "") == OFFERED
    assert _complete(said, "a") == OFFERED[:1]
    assert _complete(SimpleNamespace(params={"source": "absent.jsonl"}), "") == []
    assert _complete(SimpleNamespace(params={}), "") == []


def test_a_terminal_sees_how_far_it_is(rtron, corpus, monkeypatch):
    assert "3/3" not in rtron("classify", corpus).err
    monkeypatch.setenv("FORCE_COLOR", "1")
    ran = rtron("classify", corpus)
    assert "3/3" in ran.err
    assert len(documents(ran.out)) == 3


@pytest.mark.skipif(not DATA.is_dir(), reason="RTRON_DATA names no folder with corpus/")
@pytest.mark.parametrize(("name", "number"), [("kinetic_941", 941), ("humble", 870)])
def test_a_whole_distribution_is_read(rtron, name, number):
    ran = rtron("classify", DATA / f"{name}.jsonl")
    assert (ran.code, ran.err) == (0, "")
    assert len(documents(ran.out)) == number
