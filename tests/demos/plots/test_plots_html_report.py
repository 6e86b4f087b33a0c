"""The report of a case, and its pictures."""

import re
from base64 import b64encode
from html import unescape
from html.parser import HTMLParser

import pytest
from demo_runs import CORRIDOR, ROOM, guard_events, make_run, runs_by_variant

from rtron.demos.cases import GR, MSR
from rtron.demos.metrics.case_run import Variant
from rtron.demos.plots.html_report import CaseFindings, Picture, render_report
from rtron.demos.plots.style import require_matplotlib
from rtron.demos.plots.timeline import draw_timeline, flow_lanes
from rtron.demos.plots.trajectories import draw_trajectories
from rtron.demos.plots.velocity import draw_velocity
from rtron.demos.runtime.processes import CompletedCommand
from rtron.errors import SourceError

PNG = b"\x89PNG\r\n\x1a\n"
SAID = [CompletedCommand("rtron scan src", 1, "2 risks")]
EVIL = "<script>alert('&\"')</script>"


@pytest.fixture
def png(tmp_path):
    (tmp_path / "ways.png").write_bytes(PNG)
    return tmp_path / "ways.png"


def findings(**values):
    defaults = {
        "case": GR,
        "ros": 1,
        "runs": tuple(runs_by_variant().values()),
        "decisions": "grcn: {}\n",
    }
    return CaseFindings(**defaults | values)


class Tags(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.tags, self.attributes, self.text = [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes += attrs

    def handle_data(self, data):
        self.text.append(data)


def test_the_page_tells_everything():
    text = " ".join(Tags(render_report([findings()], SAID)).text)
    for part in (
        GR.title,
        GR.attack,
        GR.harm_description,
        GR.remedy,
        "grcn: {}",
        "$ rtron scan src",
        "2 risks",
    ):
        assert part in text
    assert "attacked, guarded" in text
    assert "700 / 0" in text


def test_a_picture_is_inside_the_page(png):
    page = render_report([findings(pictures=[Picture(png, "the ways")])], [])
    shown = dict(Tags(page).attributes)
    assert shown["src"] == "data:image/png;base64," + b64encode(PNG).decode()
    assert shown["alt"] == "the ways"


def test_nothing_from_outside_becomes_a_tag(png):
    runs = (make_run(Variant.ATTACKED, harm=EVIL),)
    said = (CompletedCommand(f"rtron {EVIL}", 0, EVIL),)
    pictures = [Picture(png, f'"{EVIL}')]
    made_page = render_report([findings(runs=runs, decisions=EVIL, pictures=pictures)], said)
    assert "script" not in Tags(made_page).tags
    assert made_page.count("<script") == 0
    assert unescape(made_page).count(EVIL) == 6


def test_what_could_steer_a_terminal_is_shown_as_text():
    text = render_report(
        [findings()], [CompletedCommand("rtron \x1b[31mred", 0, "\x1b[31mred\x07")]
    )
    assert not {"\x1b", "\x07"} & set(text)
    assert r"$ rtron \x1b[31mred" in text
    assert "<pre>red</pre>" in text


def test_each_case_has_its_part_and_the_commands_follow():
    text = render_report([findings(), findings(case=MSR, decisions="")], [])
    assert Tags(text).tags.count("h1") == 3
    assert MSR.remedy not in text


def test_the_page_allows_no_network():
    text = render_report([findings()], SAID)
    allowed = re.search(r'Policy" content="([^"]*)"', text).group(1)
    assert "default-src 'none'" in unescape(allowed)
    assert not re.search(r'(src|href)="(?!data:)', text)


def test_a_lane_tells_who_and_how_often():
    found = flow_lanes(make_run(Variant.GUARDED), ["/cmd_vel"])
    assert [(lane.publisher, lane.totals) for lane in found] == [
        ("/move_base", "200 passed"),
        ("/tb3_safe_control", "730 dropped"),
        ("whoever else", "400 dropped"),
    ]


def test_a_lanes_times_are_those_of_the_simulation():
    (lane, *_) = flow_lanes(make_run(Variant.GUARDED), ["/cmd_vel"])
    assert [began for began, _ in lane.bars][:3] == pytest.approx([0.0, 2.0, 4.0])


def test_other_topics_have_no_lane():
    assert flow_lanes(make_run(Variant.GUARDED), ["/goal"]) == ()


@pytest.mark.parametrize("scene", [CORRIDOR, ROOM])
def test_the_ways_are_drawn(tmp_path, scene):
    draw_trajectories(tmp_path / "ways.png", "ways", scene, runs_by_variant())
    assert (tmp_path / "ways.png").read_bytes().startswith(PNG)


def test_what_harm_there_was_is_marked_where_it_began():
    run = make_run(Variant.ATTACKED, harm="overspeed", harmed_at=6.02)
    assert list(run.first_harms) == ["overspeed", "collision"]
    assert run.first_harms["overspeed"].t == pytest.approx(6.05)
    assert run.first_harms["collision"] == run.samples[-1]
    assert make_run(Variant.GUARDED).first_harms == {}


@pytest.mark.parametrize("turn", [True, False])
def test_the_velocity_is_drawn(tmp_path, turn):
    draw_velocity(tmp_path / "v.png", "velocity", runs_by_variant(), turn=turn)
    assert (tmp_path / "v.png").read_bytes().startswith(PNG)


@pytest.mark.parametrize("events", [guard_events(), ()])
def test_the_decisions_are_drawn(tmp_path, events):
    draw_timeline(
        tmp_path / "t.png", "decisions", make_run(Variant.GUARDED, events=events), ["/cmd_vel"]
    )
    assert (tmp_path / "t.png").read_bytes().startswith(PNG)


def test_without_matplotlib_it_is_said_what_to_install(monkeypatch):
    monkeypatch.setattr("rtron.demos.plots.style.find_spec", lambda _: None)
    with pytest.raises(SourceError) as caught:
        require_matplotlib()
    assert caught.value.help == 'pip install "rtron[demo]"'
