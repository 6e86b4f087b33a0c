"""`rtron incident`: what it lists, shows and exports, and what it refuses."""

import csv
import json
from random import Random

import pytest
from guarded_drive import ALLOWED, FAST, speed_plan
from mcap.writer import CompressionType, Writer
from saved_incident import START, WALL, saved_incident

from rtron.vocabulary import INCIDENT_SCHEMA


@pytest.fixture
def folder(tmp_path):
    path = tmp_path / "incidents"
    path.mkdir()
    return path


@pytest.fixture
def saved(folder):
    return saved_incident(folder, [0.1] * 20 + [FAST] * 20 + [None] * 60)


def test_a_list_has_the_cause_of_each(rtron, folder, saved):
    done = rtron("incident", "list", "--dir", folder)
    assert f" {-(-saved.stat().st_size // 1000)} kB " in done.out
    assert done.code == 0
    assert saved.name in done.out
    assert "stop  /cmd_vel flow1" in done.out
    assert "and 1 more cause" in done.out


def test_a_list_as_json_names_what_cannot_be_read(rtron, folder, saved):
    (folder / "torn.mcap").write_bytes(saved.read_bytes()[:-20])
    document = json.loads(rtron("incident", "list", "--dir", folder, "--format", "json").out)
    assert document["schema"] == INCIDENT_SCHEMA
    ((good, torn),) = [each["incidents"] for each in document["folders"]]
    assert good["header"]["causes"][0]["kind"] == "intervention"
    assert torn["header"] is None
    assert "cut off" in torn["problem"]


def test_a_folder_that_is_not_there_is_2(rtron, tmp_path):
    done = rtron("incident", "list", "--dir", tmp_path / "no")
    assert (done.code, "no such folder" in done.err) == (2, True)


def test_the_usual_folder_is_that_of_the_app(rtron, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    (tmp_path / "rtron" / "drive" / "incidents").mkdir(parents=True)
    assert "0 incidents" in rtron("incident", "list", "--app", "drive").out


def test_without_a_word_all_apps_are_listed_and_found_by_name(rtron, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path))
    assert "no guard of this user" in rtron("incident", "list").out
    saved = []
    for app, speed in (("first", 0.5), ("second", 0.8)):
        folder = tmp_path / "rtron" / app / "incidents"
        folder.mkdir(parents=True)
        saved.append(saved_incident(folder, [0.1, speed]))
    newest = saved[1].rename(saved[1].with_name(f"9{saved[1].name}"))
    assert rtron("incident", "list").out.count("1 incident") == 2
    assert newest.name in rtron("incident", "show", "last").out
    assert saved[0].name in rtron("incident", "show", saved[0].name).out
    assert rtron("incident", "show", "nobody.mcap").code == 2


def test_an_app_and_a_folder_at_once_are_refused(rtron, tmp_path):
    assert rtron("incident", "list", "--app", "a", "--dir", tmp_path).code == 2


def test_what_is_shown_says_who_was_in_command_and_what_was_decided(rtron, saved):
    shown = rtron("incident", "show", saved).out
    for words in ("flow1", "/teleop", "modify", "Constrain", f"{ALLOWED:g} m/s", "stop: "):
        assert words in shown
    assert "+0.00 s" in shown


def test_json_has_the_curves(rtron, saved):
    document = json.loads(rtron("incident", "show", saved, "--format", "json").out)
    topic = document["topics"]["/cmd_vel"]
    assert [linear[0] for _, linear, _ in topic["commands"]["flow1"]] == [0.1] * 20 + [FAST] * 20
    output = [linear[0] for _, linear, _ in topic["output"]]
    assert output[:40] == [0.1] * 20 + [ALLOWED] * 20
    assert output[-1] == 0
    assert min(at for at, _, _ in topic["output"]) == pytest.approx(-1.0, abs=1e-6)
    assert {"flow": "flow1", "decision": "modify", "count": 20} in topic["verdicts"]


def test_rows_as_json_lines_have_every_message_and_verdict(rtron, saved):
    rows = [json.loads(each) for each in rtron("incident", "export", saved).out.splitlines()]
    commands = [row for row in rows if row["kind"] == "command"]
    assert [row["linear_x"] for row in commands] == [0.1] * 20 + [FAST] * 20
    assert {row["publisher"] for row in commands} == {"/teleop"}
    verdicts = [row for row in rows if row["kind"] == "verdict"]
    assert [row["decision"] for row in verdicts] == ["pass"] * 20 + ["modify"] * 20
    assert [row["at"] for row in rows] == sorted(row["at"] for row in rows)


def test_a_spreadsheet_gets_the_same_rows(rtron, saved, tmp_path):
    target = tmp_path / "out.csv"
    assert rtron("incident", "export", saved, "--format", "csv", "-o", target).code == 0
    with target.open(encoding="utf-8-sig", newline="") as file:
        rows = list(csv.DictReader(file))
    speeds = [float(row["speed"]) for row in rows if row["kind"] == "command"]
    assert speeds == [0.1] * 20 + [FAST] * 20


def test_mcap_is_copied_as_it_is(rtron, saved, tmp_path):
    target = tmp_path / "copy.mcap"
    assert rtron("incident", "export", saved, "--format", "mcap", "-o", target).code == 0
    assert target.read_bytes() == saved.read_bytes()
    assert rtron("incident", "export", saved, "--format", "mcap").code == 2
    assert rtron("incident", "export", saved, "--format", "mcap", "-o", saved).code == 2
    assert target.read_bytes() == saved.read_bytes()


def strangers_file(path, decisions=(), metadata=None, at=START + WALL):
    """Write an MCAP file as somebody else may have."""
    with path.open("wb") as stream:
        writer = Writer(stream, compression=CompressionType.NONE, use_chunking=False)
        writer.start("ros1", "a stranger")
        schema = writer.register_schema("x", "jsonschema", b"{}")
        channel = writer.register_channel("/rtron/decisions", "json", schema)
        for data in decisions:
            writer.add_message(channel, at, data, at)
        for name, values in (metadata or {}).items():
            writer.add_metadata(name, values)
        writer.finish()
    return path


@pytest.fixture
def metadata(saved):
    from rtron.sources.bag.incident import IncidentFile  # noqa: PLC0415

    return IncidentFile(saved)._metadata


@pytest.mark.parametrize(
    "data",
    [
        *(b"", b"no", b"[]", b"[" * 100_000, bytes(1 << 21)),
        *(b'{"limit": NaN}', b'{"limit": 1e999}', b'{"limit": 1%s}' % (b"0" * 400)),
    ],
    ids=["empty", "text", "list", "deep", "long", "nan", "inf", "whole"],
)
def test_a_decision_that_is_none_is_2(rtron, tmp_path, metadata, data):
    path = strangers_file(tmp_path / "bad.mcap", [data], metadata)
    for command in ("show", "export"):
        done = rtron("incident", command, path)
        assert (done.code, "no JSON" in done.err) == (2, True)


@pytest.mark.parametrize(
    "header", [None, "", "{}", "[" * 10_000, '{"causes": []}'], ids=["none", "", "{}", "[", "()"]
)
def test_a_file_that_is_no_incident_is_2(rtron, tmp_path, header):
    given = {} if header is None else {"rtron.incident": {"json": header}}
    path = strangers_file(tmp_path / "bad.mcap", [], given)
    done = rtron("incident", "show", path)
    assert (done.code, "no incident: " in done.err) == (2, True)


@pytest.mark.parametrize(
    "change",
    [
        {"begin": -1},
        {"end": 10**30},
        {"begin": 0},
        {"end": 0},
        {"causes": [{"at": 10**30, "kind": "stop", "topic": "", "flow": "", "reason": ""}]},
    ],
    ids=str,
)
def test_times_that_no_guard_has_are_2(rtron, tmp_path, metadata, change):
    header = json.loads(metadata["rtron.incident"]["json"]) | change
    given = {**metadata, "rtron.incident": {"json": json.dumps(header)}}
    path = strangers_file(tmp_path / "odd.mcap", [b"{}"], given)
    for words in (("show", "--as-planned"), ("show",), ("export",)):
        done = rtron("incident", words[0], path, *words[1:])
        assert (done.code, "no guard's" in done.err) == (2, True)


@pytest.mark.parametrize("at", [0, 2**63, 2**64 - 1])
def test_messages_of_another_time_are_2(rtron, tmp_path, metadata, at):
    path = strangers_file(tmp_path / "odd.mcap", [b"{}"], metadata, at)
    done = rtron("incident", "show", path, "--as-planned")
    assert (done.code, "of another time" in done.err) == (2, True)


def test_what_a_stranger_wrote_steers_no_terminal(rtron, tmp_path, metadata):
    header = json.loads(metadata["rtron.incident"]["json"])
    header["causes"][0]["reason"] = header["app"] = "\x1b[2J"
    document = {"kind": "alarm", "alarm": "\x1b[2J", "reason": "\x1b[2J", "active": True}
    given = {**metadata, "rtron.incident": {"json": json.dumps(header)}}
    path = strangers_file(tmp_path / "odd.mcap", [json.dumps(document).encode()], given)
    assert "\x1b" not in rtron("incident", "show", path).out
    assert "\x1b" not in rtron("incident", "list", "--dir", tmp_path).out


def test_every_truncation_is_told_and_none_a_crash(rtron, saved, tmp_path):
    whole = saved.read_bytes()
    for size in range(0, len(whole), len(whole) // 40):
        path = tmp_path / "cut.mcap"
        path.write_bytes(whole[:size])
        done = rtron("incident", "show", path)
        assert (done.code, "error: " in done.err) == (2, True)


def test_what_would_have_been_is_a_sentence_and_curves(rtron, saved):
    shown = rtron("incident", "show", saved, "--without-guard").out
    assert "1.00 m/s instead of 0.25 m/s" in shown.replace("\n", " ")
    document = json.loads(
        rtron("incident", "show", saved, "--without-guard", "--format", "json").out
    )
    topic = document["alternative"]["topics"]["/cmd_vel"]
    assert (topic["speed"], topic["actual_speed"]) == (FAST, ALLOWED)
    assert [linear[0] for _, linear, _ in topic["output"]] == [0.1] * 20 + [FAST] * 20


def test_another_plan_is_read_from_its_file(rtron, saved, tmp_path):
    from rtron.planning.plan_file.writer import write_plan  # noqa: PLC0415

    plan = tmp_path / "other.yaml"
    plan.write_text(write_plan(speed_plan(limit=0.5)))
    shown = rtron("incident", "show", saved, "--plan", plan).out
    assert "0.50 m/s instead of 0.25 m/s" in shown.replace("\n", " ")
    assert "the same went out" in rtron("incident", "show", saved, "--as-planned").out


def test_two_alternatives_at_once_are_refused(rtron, saved):
    assert rtron("incident", "show", saved, "--without-guard", "--as-planned").code == 2


@pytest.mark.parametrize(("ending", "begin"), [("png", b"\x89PNG"), ("svg", b"<?xml")])
def test_a_picture_is_drawn(rtron, saved, tmp_path, ending, begin):
    picture = tmp_path / f"incident.{ending}"
    assert rtron("incident", "show", saved, "--without-guard", "--picture", picture).code == 0
    assert picture.read_bytes().startswith(begin)


def test_a_picture_that_cannot_be_is_2(rtron, saved, tmp_path):
    assert rtron("incident", "show", saved, "--picture", tmp_path / "a.txt").code == 2
    assert rtron("incident", "show", saved, "--picture", tmp_path / "no" / "a.png").code == 2


@pytest.mark.parametrize("seed", range(60))
def test_a_damaged_file_is_shown_or_told_and_never_a_crash(rtron, saved, tmp_path, seed):
    data, chance = bytearray(saved.read_bytes()), Random(seed)
    for _ in range(chance.choice((1, 3, 30))):
        data[chance.randrange(len(data))] = chance.randrange(256)
    path = tmp_path / "flipped.mcap"
    path.write_bytes(data)
    for words in (("show", "--without-guard"), ("show", "--as-planned"), ("export",)):
        done = rtron("incident", words[0], path, *words[1:])
        assert done.code in (0, 2)
        assert done.code == 0 or "error: " in done.err


def test_a_plan_in_it_that_no_guard_runs_is_told(rtron, tmp_path, metadata):
    plan = json.loads(metadata["rtron.plan"]["json"])
    plan["grcn"][0]["topic"] = "no topic"
    given = {**metadata, "rtron.plan": {"json": json.dumps(plan)}}
    path = strangers_file(tmp_path / "odd.mcap", [b"{}"], given)
    done = rtron("incident", "show", path, "--as-planned")
    assert (done.code, "a full topic name" in done.err) == (2, True)
    assert rtron("incident", "show", path).code == 0
