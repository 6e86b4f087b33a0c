"""The four cases: what is malicious, and the developer's decisions."""

import pytest
from demo_runs import CORRIDOR, ROOM

from rtron.demos.cases import AGENT, CASES, GR, MSR, RSR, RunConditions
from rtron.demos.cases.case_study import merge_decisions
from rtron.demos.experiment.study import worlds_by_decisions
from rtron.vocabulary import CommanderRank


def setting(speed=1.0, rate=10.0):
    return RunConditions(scene=ROOM, speed=speed, rate=rate)


def test_each_case_is_known_by_its_name():
    names = ("gr", "rsr", "msr", "agent")
    assert {name: case.name for name, case in CASES.items()} == {name: name for name in names}


@pytest.mark.parametrize(
    ("case", "topic", "value"),
    [
        (GR, "/cmd_vel", (0.0, -0.2)),
        (RSR, "/control/max_vel", (2.0,)),
        (MSR, "/move_base_simple/goal", (2.7, 0.7)),
        (MSR, "/move_base_simple/goal", (2.7, 0.7, 0.3)),
        (AGENT, "/cmd_vel", (0.8, 0.03)),
        (AGENT, "/cmd_vel", (0.0, -1.2)),
    ],
)
def test_the_attackers_value_is_malicious_on_its_topic_only(case, topic, value):
    assert case.is_malicious(topic, value, ROOM)
    assert not case.is_malicious("/odom", value, ROOM)


@pytest.mark.parametrize(
    ("case", "topic", "value"),
    [
        (GR, "/cmd_vel", (0.22, -0.2)),
        (GR, "/cmd_vel", (0.0, 0.2)),
        (RSR, "/control/max_vel", (0.22,)),
        (MSR, "/move_base_simple/goal", (4.5, 2.2)),
        (AGENT, "/cmd_vel", (0.22, 0.5)),
        (AGENT, "/cmd_vel", (0.0, 0.0)),
    ],
)
def test_what_the_app_says_is_not(case, topic, value):
    assert not case.is_malicious(topic, value, ROOM)


def test_the_navigation_goes_before_the_safe_control():
    chosen = GR.decisions(setting())["grcn"]["/cmd_vel"]
    assert chosen["policy"] == "Preemption"
    assert chosen["block_unapproved"] is True
    assert chosen["flows"]["/move_base"]["priority"] > chosen["flows"][GR.attacker]["priority"]


@pytest.mark.parametrize(("speed", "rate"), [(1.0, 10.0), (1.0, 20.0), (3.0, 10.0), (0.25, 5.0)])
def test_the_threshold_lets_the_robot_cruise_at_the_cameras_rate(speed, rate):
    decided = RSR.decisions(setting(speed, rate))
    per_frame = float(decided["rsrcn"]["threshold"].removesuffix(" m/frame"))
    allowed = per_frame * speed * rate
    assert allowed == pytest.approx(0.308, rel=1e-3)
    assert allowed / 2 < 0.22
    assert decided["rsrcn"]["max_vel_limit"] == "0.22 m/s"


@pytest.mark.parametrize(("speed", "rate"), [(1.0, 10.0), (8.0, 20.0), (0.25, 5.0)])
def test_the_window_has_frames_enough_to_count(speed, rate):
    (monitor,) = RSR.decisions(setting(speed, rate))["fps_monitor"]
    window = float(monitor["window"].removesuffix(" s"))
    assert window >= 0.3
    assert monitor["silent_after"] == monitor["window"]
    assert window * speed * rate >= 3.99


@pytest.mark.parametrize("case", [GR, MSR, AGENT])
@pytest.mark.parametrize("speed", [0.25, 2.0])
def test_who_tells_the_maximal_velocity_once_a_second_keeps_control(case, speed):
    decided = case.decisions(setting(speed))["grcn"]["/control/max_vel"]
    assert float(decided["release_after"].removesuffix(" s")) * speed == pytest.approx(3)


@pytest.mark.parametrize(
    ("case", "topic"), [(MSR, "/move_base_simple/goal"), (AGENT, "/teleop/cmd_vel")]
)
def test_the_area_without_network_is_that_of_the_world(case, topic):
    decided = case.decisions(setting())["msrcn"]
    (area,) = decided["areas"]
    corners = [(corner["x"], corner["y"]) for corner in area["polygon"]]
    assert corners == [
        ("1.8 m", "0.2 m"),
        ("3.6 m", "0.2 m"),
        ("3.6 m", "1.1 m"),
        ("1.8 m", "1.1 m"),
    ]
    (rule,) = decided["rules"]
    assert rule["block"] == decided["aflows"] == [topic]


def test_a_person_has_a_higher_rank_than_the_agent():
    decided = AGENT.decisions(setting())
    chosen = decided["grcn"]["/teleop/cmd_vel"]
    ranks = [CommanderRank(each["rank"]) for each in chosen["flows"].values()]
    assert ranks == [CommanderRank.OPERATOR_ON_SITE, CommanderRank.AGENT]
    assert decided["clients"] == {"/teleop/cmd_vel": [AGENT.attacker]}
    assert [each["name"] for each in decided["leases"]] == [chosen["lease"]]


def test_only_where_the_world_decides_the_plan_depends_on_it():
    other = RunConditions(scene=CORRIDOR, speed=1.0, rate=10.0)
    same = {
        case.name for case in CASES.values() if case.decisions(setting()) == case.decisions(other)
    }
    assert same == {"gr", "rsr"}


def test_worlds_in_a_row_share_a_guarded_app_where_the_same_is_decided():
    slow, fast = setting(rate=5.0), setting(rate=10.0)
    settings = {1: fast, 2: fast, 3: slow, 4: fast}
    found = worlds_by_decisions([RSR], list(settings), lambda _, seed: settings[seed])
    assert [seeds for _, seeds in found] == [[1, 2], [3], [4]]
    decided = [decisions for decisions, _ in found]
    assert decided == [RSR.decisions(one) for one in (fast, slow, fast)]


def test_one_guarded_app_stands_against_all_cases():
    ((decided, _),) = worlds_by_decisions(list(CASES.values()), [1, 2], lambda *_: setting())
    each = {name: case.decisions(setting()) for name, case in CASES.items()}
    assert decided["grcn"]["/cmd_vel"] == each["gr"]["grcn"]["/cmd_vel"]
    assert decided["grcn"]["/control/max_vel"] == {"policy": "Block", "release_after": "3 s"}
    assert decided["rsrcn"] == each["rsr"]["rsrcn"]
    assert decided["fps_monitor"] == each["rsr"]["fps_monitor"]
    for name, of_agent in each["agent"]["msrcn"].items():
        of_msr = each["msr"]["msrcn"].get(name, [])
        assert sorted(decided["msrcn"][name], key=str) == sorted([*of_msr, *of_agent], key=str)
    for name in ("clients", "leases", "incidents"):
        assert decided[name] == each["agent"][name]


def test_no_case_takes_back_what_another_decides():
    each = [case.decisions(setting()) for case in CASES.values()]
    assert merge_decisions(each) == merge_decisions(reversed(each))
