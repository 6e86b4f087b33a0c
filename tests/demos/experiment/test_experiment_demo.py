"""The demonstration without a ROS: what it wants, what it writes, what it says, how it ends."""

import json
from types import SimpleNamespace

import pytest
from demo_runs import CORRIDOR, make_run, runs_by_variant

from rtron.cli.commands.demo import CaseName, choose_ros, demo, require_demo_packages, show_console
from rtron.demos.cases import GR, RunConditions
from rtron.demos.experiment.demonstration import DemoRequest, are_as_expected, demo_text
from rtron.demos.experiment.results import results_document, write_results
from rtron.demos.metrics.case_run import Variant
from rtron.demos.metrics.message_journal import Attack
from rtron.demos.runtime import ros_installation
from rtron.demos.runtime.processes import CompletedCommand
from rtron.errors import InputError, SourceError
from rtron.vocabulary import Domain, Risk, RiskKind, Severity
from rtron.workflows.live_app import RosGeneration

WISH = DemoRequest(cases=[GR], seeds=[1], ros=1, speed=2.0)
RISK = Risk(
    id=GR.risk,
    kind=RiskKind.GR_ST,
    rule="gr_st",
    severity=Severity.HIGH,
    domain=Domain.CONTROL,
    role_nodes={},
    topics=(GR.topic,),
    message_type="geometry_msgs/Twist",
    successors=("/turtlebot3_core",),
    reason="both publish \x1b[31m",
)


class FakeStudy:
    """What a study has found, without one."""

    def __init__(self, folder, runs):
        self.runs = runs
        self.decisions = {"gr": GR.decisions(RunConditions(scene=CORRIDOR, speed=2.0, rate=10.0))}
        self.plan = "app: tb3\n"
        self.commands = [CompletedCommand("rtron scan", 1, "\x1b[1mrisks\x1b[0m")]
        self.pipeline = SimpleNamespace(folder=folder)
        self.incidents = {}

    def runs_of(self, _case, seed):
        return {run.variant: run for run in self.runs if run.seed == seed}

    def without_guard(self, case):
        return {seed: each.sentence for (_, seed), each in self.incidents.items()}

    def risks(self):
        return (RISK,)


@pytest.fixture
def fake_study(tmp_path):
    work = tmp_path / "work"
    (work / "log").mkdir(parents=True)
    (work / "log" / "01-world.log").write_text("fine")
    (work / "graph.json").write_text("{}")
    return FakeStudy(work, list(runs_by_variant().values()))


def test_it_is_as_expected_only_if_the_attack_does_harm_without_the_guard_alone():
    assert are_as_expected(list(runs_by_variant().values()))
    assert are_as_expected([make_run(Variant.ATTACKED)])
    assert not are_as_expected([make_run(Variant.ATTACKED, harm="", completed=True)])
    assert not are_as_expected([make_run(Variant.GUARDED, harm="collision")])
    assert not are_as_expected([make_run(Variant.GUARDED, completed=False)])
    assert not are_as_expected([make_run(Variant.GUARDED, attack=Attack())])
    assert not are_as_expected([make_run(Variant.UNATTACKED, completed=False)])


def test_how_many_runs_it_takes():
    assert WISH.runs == 3
    assert DemoRequest(cases=[GR, GR], seeds=[1, 2], ros=1, speed=2.0, guard=False).runs == 8


def test_everything_is_written(tmp_path, fake_study):
    names = write_results(tmp_path, WISH, fake_study)
    assert names[0] == "report.html"
    assert {path.name for path in tmp_path.iterdir()} >= {*names, "graph.json", "log"}
    assert "gr-verdicts.png" in names
    assert (tmp_path / "rtron.yaml").read_text() == "app: tb3\n"
    page = (tmp_path / "report.html").read_text()
    assert page.count("data:image/png;base64,") == 3
    assert "policy: Preemption" in page
    assert "\x1b" not in page
    assert "&amp;id" not in page


def test_an_incident_is_drawn_told_and_copied(tmp_path, fake_study):
    saved = fake_study.pipeline.folder / "saved.mcap"
    saved.write_bytes(b"MCAP")
    sentence = "/cmd_vel: 0.80 m/s instead of 0.22 m/s"
    drawn = SimpleNamespace(
        path=saved, sentence=sentence, draw=lambda path: path.write_bytes(b"PNG")
    )
    fake_study.incidents["gr", 1] = drawn
    names = write_results(tmp_path, WISH, fake_study)
    assert "gr-incident.png" in names
    assert (tmp_path / "gr-incident.mcap").read_bytes() == b"MCAP"
    assert sentence in (tmp_path / "report.html").read_text()
    assert sentence in " ".join(demo_text(WISH, fake_study).split())
    (case,) = results_document(WISH, fake_study)["cases"]
    assert case["without_guard"] == {1: sentence}


def test_the_results_have_every_moment(tmp_path, fake_study):
    write_results(tmp_path, WISH, fake_study)
    results = json.loads((tmp_path / "results.json").read_text())
    (case,) = results["cases"]
    assert [run["variant"] for run in case["runs"]] == ["unattacked", "attacked", "guarded"]
    assert len(case["runs"][1]["samples"]) == len(fake_study.runs[1].samples)
    assert "samples" not in json.dumps(results_document(WISH, fake_study))


def test_without_the_guard_there_are_no_decisions_to_show(tmp_path, fake_study):
    fake_study.runs, fake_study.decisions, fake_study.plan = fake_study.runs[:2], {}, ""
    names = write_results(tmp_path, WISH, fake_study)
    assert not {"gr-verdicts.png", "rtron.yaml"} & set(names)
    assert GR.remedy not in (tmp_path / "report.html").read_text()


def test_what_is_said_has_the_risk_and_the_table(fake_study):
    text = demo_text(WISH, fake_study)
    assert "rtron scan finds 1 risks" in text
    assert GR.risk in text
    assert "700 / 0" in text
    assert "\x1b[31m" not in text


def test_it_says_which_packages_are_missing(monkeypatch):
    monkeypatch.setattr(
        "rtron.cli.commands.demo.find_spec", lambda name: None if name == "irsim" else 1
    )
    with pytest.raises(InputError, match="the demo needs irsim") as caught:
        require_demo_packages()
    assert caught.value.help == 'pip install "rtron[demo]"'


@pytest.mark.parametrize(
    ("lacks", "chosen"), [({1: "", 2: ""}, 2), ({1: "", 2: "none"}, 1), ({1: "none", 2: ""}, 2)]
)
def test_ros_2_is_taken_before_ros_1(monkeypatch, lacks, chosen):
    monkeypatch.setattr(ros_installation, "missing_requirements", lambda: lacks)
    assert choose_ros(RosGeneration.AUTO) == chosen


def test_without_any_ros_it_says_what_is_lacking(monkeypatch):
    monkeypatch.setattr(
        ros_installation, "missing_requirements", lambda: {1: "no ROS 1", 2: "no ROS 2"}
    )
    with pytest.raises(SourceError, match="no ROS 2; no ROS 1"):
        choose_ros(RosGeneration.AUTO)


def test_the_console_shows_only_what_was_guarded():
    with pytest.raises(InputError, match="both --console and --no-guard"):
        demo(CaseName.GR, guard=False, console=True)


@pytest.mark.parametrize("screen", ["", ":0"])
def test_the_console_is_opened_where_there_is_a_screen(monkeypatch, screen):
    opened = []
    monkeypatch.delenv("WAYLAND_DISPLAY", raising=False)
    monkeypatch.setenv("DISPLAY", screen)
    monkeypatch.setattr("webbrowser.open", opened.append)
    monkeypatch.setattr("threading.Event.wait", lambda _: None)
    show_console(SimpleNamespace(page="http://here/", password="word"))
    assert opened == (["http://here/"] if screen else [])


@pytest.mark.parametrize("aside", [False, True])
def test_the_console_is_told_beside_what_a_program_reads(capsys, monkeypatch, aside):
    def interrupt(_):
        raise KeyboardInterrupt

    monkeypatch.setattr("threading.Event.wait", interrupt)
    monkeypatch.setattr("webbrowser.open", lambda _: True)
    service = SimpleNamespace(page="http://here/#/robots/tb3/events", password="word")
    show_console(service, to_stderr=aside)
    message, other = capsys.readouterr() if not aside else reversed(capsys.readouterr())
    assert "http://here/#/robots/tb3/events" in message
    assert "password word" in message
    assert other == ""
