import io
import json
import sys
from types import ModuleType, SimpleNamespace

import pytest

from rtron.functions.node_functions import with_functions
from rtron.sources.graph_json import read_graph


def test_risks_found_is_1(rtron, graph_file):
    ran = rtron("scan", graph_file)
    assert ran.code == 1
    assert ran.err == ""
    assert "/keyboard and /planner both drive the robot on /cmd_vel\n" in ran.out
    assert "no arbiter stands between them: /base obeys whoever published last" in ran.out
    assert f"rtron plan {graph_file} -o rtron.yaml" in ran.out
    assert "\x1b" not in ran.out


def test_nothing_found_is_0(rtron, quiet_file):
    ran = rtron("scan", quiet_file)
    assert ran.code == 0
    assert "no findings" in ran.out
    assert "no risks found" not in ran.out
    assert "no risks found" in rtron("scan", quiet_file, "--level", "auditor").out


def test_an_app_of_which_nothing_could_be_read_is_no_success(rtron, quiet_file):
    document = json.loads(quiet_file.read_text())
    document["unresolved"] = [{"what": "include a.launch", "why": "its path is not known"}]
    quiet_file.write_text(json.dumps(document))
    assert rtron("scan", quiet_file).code == 1
    assert rtron("scan", quiet_file, "--fail-on", "never").code == 0


def test_the_papers_risks_are_drawn_for_auditors(rtron, graph_file):
    ran = rtron("scan", graph_file, "--level", "auditor")
    assert "/keyboard (third party) ─┬─► /cmd_vel ───► /base" in ran.out


def test_levels_show_more_and_more(rtron, graph_file):
    lengths = [
        len(rtron("scan", graph_file, "--level", level).out)
        for level in ("regular", "pedantic", "auditor")
    ]
    assert lengths == sorted(lengths)


def test_json_has_every_finding_whatever_the_level(rtron, graph_file):
    findings = json.loads(rtron("scan", graph_file, "--format", "json").out)["findings"]
    assert findings[0]["id"] == "several_publishers:/cmd_vel"
    assert len({each["fingerprint"] for each in findings}) == len(findings)


@pytest.mark.parametrize(
    ("fail_on", "code"), [("low", 1), ("medium", 1), ("high", 1), ("never", 0)]
)
def test_fail_on_with_a_high_risk(rtron, graph_file, fail_on, code):
    assert rtron("scan", graph_file, "--fail-on", fail_on).code == code


def test_fail_on_with_milder_risks_only(rtron, graph_file):
    document = json.loads(graph_file.read_text())
    document["nodes"] = [{"name": n, "trust": "own"} for n in ("/keyboard", "/planner", "/base")]
    graph_file.write_text(json.dumps(document))
    risks = json.loads(rtron("scan", graph_file, "--format", "json").out)["risks"]
    assert {risk["severity"] for risk in risks} == {"medium"}
    assert rtron("scan", graph_file, "--fail-on", "high").code == 0
    assert rtron("scan", graph_file, "--fail-on", "medium").code == 1


def test_json_is_the_contract(rtron, graph_file):
    ran = rtron("scan", graph_file, "--format", "json")
    document = json.loads(ran.out)
    assert ran.code == 1
    assert document["schema"] == "rtron.risks/2"
    assert document["summary"]["GR-ST"] == 1
    assert document["coordination_nodes"]["GRCN"] == {"Perception": 0, "Planning": 0, "Control": 1}


def test_the_graph_is_written_as_it_is_read(rtron, graph_file, tmp_path):
    copy = tmp_path / "copy.json"
    ran = rtron("scan", graph_file, "--format", "graph", "-o", copy, "--fail-on", "never")
    assert (ran.code, ran.out) == (0, "")
    assert read_graph(copy) == with_functions(read_graph(graph_file))


def test_dot(rtron, graph_file):
    out = rtron("scan", graph_file, "--format", "dot").out
    assert out.startswith("digraph")
    assert 'label="/cmd_vel"' in out


def test_standard_input_and_output(rtron, graph_file, monkeypatch):
    stdin = SimpleNamespace(buffer=io.BytesIO(graph_file.read_bytes()))
    monkeypatch.setattr(sys, "stdin", stdin)
    ran = rtron("scan", "-", "-o", "-")
    assert ran.code == 1
    assert "read from standard input" in ran.out
    assert "rtron plan GRAPH.json -o rtron.yaml" in ran.out


def test_text_in_a_file_has_no_colour(rtron, graph_file, tmp_path, monkeypatch):
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert "\x1b[" in rtron("scan", graph_file).out
    rtron("scan", graph_file, "-o", tmp_path / "report.txt")
    assert "\x1b" not in (tmp_path / "report.txt").read_text()


def test_lists_add_to_the_rules(rtron, tmp_path, graph_file):
    document = json.loads(graph_file.read_text())
    document["endpoints"][0]["type"] = document["endpoints"][1]["type"] = "my_msgs/Alarm"
    graph_file.write_text(json.dumps(document))
    lists = tmp_path / "lists.yaml"
    lists.write_text("event_msg_type: [my_msgs/Alarm]\n")

    def events(*arguments):
        return json.loads(rtron("scan", graph_file, "--format", "json", *arguments).out)["summary"]

    assert events()["MSR"] + 1 == events("--name-lists", lists)["MSR"]


def test_a_running_app(rtron, graph_file, monkeypatch):
    asked = []

    class Ros1LiveSource:
        def __init__(self, master_uri, timeout):
            asked.append((master_uri, timeout))

        def read(self):
            return read_graph(graph_file)

    module = ModuleType("rtron.sources.live.ros1.source")
    module.Ros1LiveSource = Ros1LiveSource
    monkeypatch.setitem(sys.modules, "rtron.sources.live.ros1.source", module)
    ran = rtron("scan", "--live", "--master", "http://robot:11311", "--timeout", "2")
    assert ran.code == 1
    assert "the app running at http://robot:11311" in ran.out
    assert "rtron plan --live -o rtron.yaml" in ran.out
    monkeypatch.setenv("ROS_MASTER_URI", "http://other:1")
    monkeypatch.setenv("ROS_VERSION", "1")
    rtron("plan", "--live")
    assert asked == [("http://robot:11311", 2.0), ("http://other:1", 5.0)]


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ([], "no app to read"),
        (["none.json"], "none.json: No such file or directory"),
        (["none.json", "--live"], "both none.json and --live"),
        (["none.json", "--format", "xml"], "xml"),
        (["none.json", "--fail-on", "worst"], "worst"),
        (["none.json", "--timeout", "0"], "--timeout"),
        (["none.json", "surplus"], "surplus"),
    ],
)
def test_bad_arguments_are_2_and_said_on_stderr(rtron, arguments, said):
    ran = rtron("scan", *arguments)
    assert (ran.code, ran.out) == (2, "")
    assert said in ran.err
    assert "help" in ran.err


@pytest.mark.parametrize(
    "content", [b"", b"\xff\xfe\x00", b"{", b"[]", b'{"schema":"rtron.graph/9"}', b"\0" * 100]
)
def test_bad_files_are_2_with_a_help_line(rtron, graph_file, content):
    graph_file.write_bytes(content)
    ran = rtron("scan", graph_file)
    assert (ran.code, ran.out) == (2, "")
    assert ran.err.startswith(f"error: {graph_file}")
    assert "\nhelp: " in ran.err


def test_a_place_that_cannot_be_written_is_2(rtron, graph_file, tmp_path):
    ran = rtron("scan", graph_file, "-o", tmp_path / "none" / "report.txt")
    assert ran.code == 2
    assert "No such file" in ran.err


def test_errors_repeat_hostile_words_harmlessly(rtron, graph_file):
    graph_file.write_text('{"schema": "rtron.graph/1", "\\u001b[2J[bold]": 1}')
    ran = rtron("scan", graph_file)
    assert ran.code == 2
    assert "\\x1b[2J[bold]: is not a key" in ran.err
    assert "\x1b" not in ran.err


def test_hostile_names_go_through_every_format(rtron, graph_file):
    document = json.loads(graph_file.read_text())
    name = '/\x1b[31m[bold]"\\\n\u202e</script>'
    for each in document["endpoints"]:
        each["node"] += name
    graph_file.write_text(json.dumps(document))
    for format in ("text", "json", "graph", "dot"):
        ran = rtron("scan", graph_file, "--format", format)
        assert ran.code == 1
        assert "\x1b" not in ran.out
        assert "\u202e" not in ran.out
