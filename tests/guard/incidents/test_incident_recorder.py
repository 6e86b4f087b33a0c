"""The recorder as a process of its own, from the streams of a guard to the incident's file."""

import fcntl
import json
import os
import resource
import signal

import pytest
from guarded_drive import ALLOWED, FAST, LIMIT_S, TOPIC, recorded_drive, run_until, speed_plan
from jsonschema import validate
from mcap.reader import make_reader
from velocity_messages import twist

from rtron.errors import SourceError
from rtron.guard.incidents import incident_folder, recorder_link
from rtron.guard.incidents.entries import AlarmSwitched, LearnedType, RecorderTask, Sent
from rtron.guard.incidents.incident_folder import IncidentFolder
from rtron.guard.incidents.recorder import IncidentRecorder
from rtron.guard.system.machine_time import MachineTime
from rtron.guard.system.unix_socket import open_own_folder
from rtron.messages.common.encoding import Encoding
from rtron.sources.bag.incident import decode_header, decode_plan
from rtron.vocabulary import SECOND, Alarm, AlarmKind, Settings
from rtron.wire.common.incident_format import encode_settings

IN, OUT, DECISIONS = "/rtron/cmd_vel/flow1", "/rtron/cmd_vel/out", "/rtron/decisions"


def files(folder):
    return sorted(folder.glob("*.mcap"))


def content(path):
    """Return the messages of a file by channel, their schemas, and the metadata."""
    with path.open("rb") as stream:
        reader = make_reader(stream)
        messages, schemas = {}, {}
        for schema, channel, message in reader.iter_messages():
            messages.setdefault(channel.topic, []).append(message)
            schemas[channel.topic] = schema
        metadata = {each.name: each.metadata for each in reader.iter_metadata()}
    return messages, schemas, metadata


def decisions(messages, kind):
    found = [json.loads(each.data) for each in messages[DECISIONS]]
    return [each for each in found if each["kind"] == kind]


def recorder_task(folder, plan=None):
    return RecorderTask(plan or speed_plan(), encode_settings(Settings()), str(folder))


def drive_into_incident(folder, drive, number=1):
    run_until(drive, lambda: len(files(folder)) >= number, every_step=lambda: drive.command(FAST))


def test_an_intervention_is_saved_with_what_decided_it(tmp_path):
    with recorded_drive(tmp_path) as drive:
        drive_into_incident(tmp_path, drive)
        (path,) = files(tmp_path)
        messages, schemas, metadata = content(path)
        commands, driven = messages[IN], messages[OUT]
        prefix = Encoding.ROS1.prefix(48)
        assert {prefix + each.data for each in commands} == {twist(x=FAST)}
        assert {prefix + each.data for each in driven} == {twist(x=ALLOWED)}
        assert (schemas[IN].name, schemas[IN].encoding) == ("geometry_msgs/Twist", "ros1msg")
        assert "float64 x" in schemas[IN].data.decode()
        verdict = decisions(messages, "verdict")[0]
        assert (verdict["decision"], verdict["publisher"]) == ("modify", "/teleop")
        assert decisions(messages, "control")[-1]["limit"] == ALLOWED
        header = decode_header(metadata)
        assert (header.causes[0].kind, header.causes[0].topic) == ("intervention", TOPIC)
        assert decode_plan(metadata)[0] == speed_plan()
        end = header.causes[0].at + SECOND // 2
        assert header.end == end
        assert max(each.log_time for each in commands) <= end


def test_decisions_are_as_their_schema_says(tmp_path):
    with recorded_drive(tmp_path) as drive:
        drive_into_incident(tmp_path, drive)
    messages, schemas, _ = content(files(tmp_path)[0])
    schema = json.loads(schemas[DECISIONS].data)
    for message in messages[DECISIONS]:
        validate(json.loads(message.data), schema)


def test_an_alarm_is_an_incident(tmp_path):
    alarm = Alarm(kind=AlarmKind.INTRUSION, reason="/ghost publishes", topic=TOPIC)
    with recorded_drive(tmp_path) as drive:
        saved = []
        drive.link.on_saved = saved.append
        drive.host.alarms.raise_(alarm, drive.loop.now())
        run_until(drive, lambda: files(tmp_path))
        run_until(drive, drive.link.statuses)
        assert drive.link.statuses()[0].values["last incident"] == files(tmp_path)[0].name
        assert saved == [files(tmp_path)[0].name]
    assert "alarm-cmd_vel" in files(tmp_path)[0].name


def test_a_guard_that_ends_saves_what_has_begun(tmp_path):
    with recorded_drive(tmp_path, speed_plan(after=60 * SECOND)) as drive:
        run_until(
            drive, lambda: list((tmp_path / "ring").glob("*")), every_step=lambda: drive.command(1)
        )
    assert len(files(tmp_path)) == 1


def test_a_killed_recorder_is_followed_by_one_that_has_its_minute(tmp_path):
    with recorded_drive(tmp_path) as drive:
        ring = tmp_path / "ring"
        run_until(
            drive,
            lambda: any(path.stat().st_size > 2000 for path in ring.glob("*")),
            every_step=drive.be_slow,
        )
        former = drive.recorder.process
        former.send_signal(signal.SIGKILL)
        former.wait(LIMIT_S)
        drive_into_incident(tmp_path, drive)
        assert drive.recorder.process is not former
    messages, _, _ = content(files(tmp_path)[0])
    speeds = {each.data for each in messages[IN]}
    assert {twist(x=0.1)[4:], twist(x=FAST)[4:]} == speeds


def test_two_guards_do_not_share_a_folder(tmp_path):
    with (tmp_path / "lock").open("wb") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        with recorded_drive(tmp_path) as drive:
            run_until(drive, drive.link.statuses)
            assert "another guard records there" in drive.link.statuses()[0].message


def test_a_folder_that_cannot_be_used_is_said_and_costs_no_command(tmp_path):
    (tmp_path / "ring").write_text("in the way")
    with recorded_drive(tmp_path) as drive:
        run_until(drive, drive.link.statuses, every_step=drive.be_slow)
        assert drive.link.statuses()[0].message.startswith("not recorded: ")
        assert drive.driven


@pytest.mark.parametrize("most", [1, 3])
def test_the_folder_is_bounded_and_the_oldest_makes_room(tmp_path, most, caplog):
    folder = IncidentFolder(tmp_path, most * 1000)
    for number in range(5):
        folder.make_room(1000)
        folder.new_path(number * SECOND, "stop", "/cmd_vel").write_bytes(bytes(1000))
    folder.close()
    left = [path.name for path in files(tmp_path)]
    assert left == [f"19700101T00000{n}.000Z-stop-cmd_vel.mcap" for n in range(5 - most, 5)]
    assert caplog.text.count("was removed to make room") == 5 - most


def test_a_disk_that_refuses_is_said_and_used_again_when_it_can_be(tmp_path):
    ring, unlimited = tmp_path / "ring", (resource.RLIM_INFINITY, resource.RLIM_INFINITY)
    with recorded_drive(tmp_path) as drive:

        def serve_until(condition):
            run_until(drive, condition, every_step=drive.be_slow)

        serve_until(lambda: list(ring.glob("*")))
        resource.prlimit(drive.recorder.process.pid, resource.RLIMIT_FSIZE, (1, unlimited[1]))
        serve_until(drive.link.statuses)
        assert "File too large" in drive.link.statuses()[0].message
        former = len(drive.driven)
        resource.prlimit(drive.recorder.process.pid, resource.RLIMIT_FSIZE, unlimited)
        serve_until(lambda: not drive.link.statuses())
        assert len(drive.driven) > former


def test_a_ring_of_before_the_machine_was_started_anew_is_emptied(tmp_path):
    folder = IncidentFolder(tmp_path, 1000)
    assert folder.lock()
    segment = folder.ring / "00000001-5.mcap"
    segment.write_bytes(b"")
    folder.close()
    again = IncidentFolder(tmp_path, 1000)
    assert again.lock()
    assert segment.exists()
    again.close()
    (tmp_path / "ring" / "boot").write_text("another")
    other = IncidentFolder(tmp_path, 1000)
    assert other.lock()
    assert not segment.exists()
    other.close()


def test_where_nobody_says_whether_the_machine_was_started_anew_its_runtime_folder_does(
    tmp_path, monkeypatch
):
    runtime = tmp_path / "run"
    runtime.mkdir(mode=0o700)
    monkeypatch.setenv("XDG_RUNTIME_DIR", str(runtime))
    monkeypatch.setattr(incident_folder, "machine_time", lambda: MachineTime(0, ""))

    def has_kept(segment):
        folder = IncidentFolder(tmp_path, 1000)
        assert folder.lock()
        folder.close()
        return segment.exists()

    segment = tmp_path / "ring" / "00000001-5.mcap"
    has_kept(segment)
    segment.write_bytes(b"")
    assert has_kept(segment)
    for each in runtime.iterdir():
        each.unlink()
    assert not has_kept(segment)
    runtime.chmod(0o777)
    for _ in range(2):
        with pytest.raises(SourceError, match="others may enter"):
            IncidentRecorder.open(recorder_task(tmp_path))
    runtime.chmod(0o700)
    assert IncidentRecorder.open(recorder_task(tmp_path))


def test_an_incident_that_the_disk_refuses_is_tried_again(tmp_path, caplog):
    plan = speed_plan(after=60 * SECOND)
    task = recorder_task(tmp_path, plan)
    recorder = IncidentRecorder.open(task, lambda: 0)
    at = 100 * SECOND
    recorder.add((AlarmSwitched(at, "intrusion", TOPIC, "/ghost", active=True),), at)
    now = at + 61 * SECOND
    tmp_path.chmod(0o500)
    in_the_way = tmp_path / "19700101T000140.000Z-alarm-cmd_vel.mcap.part"
    in_the_way.mkdir()
    assert recorder.tick(now)
    assert not recorder.save_step(now)
    assert "cannot be saved" in caplog.text
    in_the_way.rmdir()
    tmp_path.chmod(0o700)
    assert not recorder.tick(now + SECOND)
    assert recorder.tick(now + 6 * SECOND)
    while recorder.save_step(now):
        pass
    recorder.close(now)
    assert len(files(tmp_path)) == 1


def two_incidents_have_begun(folder):
    recorder = IncidentRecorder.open(recorder_task(folder, speed_plan(after=5 * SECOND)), lambda: 0)
    first, second = 100 * SECOND, 105 * SECOND + SECOND // 5
    recorder.add((AlarmSwitched(first, "intrusion", TOPIC, "/ghost", active=True),), first)
    recorder.add((AlarmSwitched(second, "guard", TOPIC, "it stands still", active=True),), second)
    return recorder, second


def test_a_recorder_that_ends_saves_what_has_begun_and_what_is_behind_its_end(tmp_path):
    recorder, now = two_incidents_have_begun(tmp_path)
    recorder.close(now)
    headers = [decode_header(content(path)[2]) for path in files(tmp_path)]
    assert [[cause.reason for cause in each.causes] for each in headers] == [
        ["intrusion: /ghost"],
        ["guard: it stands still"],
    ]


def test_a_recorder_ends_though_the_disk_refuses(tmp_path, caplog):
    recorder, now = two_incidents_have_begun(tmp_path)
    (tmp_path / "19700101T000140.000Z-alarm-cmd_vel.mcap.part").mkdir()
    recorder.close(now)
    assert "cannot be saved" in caplog.text
    assert files(tmp_path) == []


def test_what_a_publisher_says_of_its_type_cannot_end_the_recorder(tmp_path):
    task = recorder_task(tmp_path)
    recorder = IncidentRecorder.open(task, lambda: 0)
    odd = LearnedType(TOPIC, "a/\udcff", "\udcff", "float64 x\udcff" * 100_000, ())
    sent = Sent(SECOND, TOPIC, "flow1", b"\x00" * 12, 12, "")
    recorder.add((odd, sent), SECOND)
    recorder.close(SECOND)
    (segment,) = (tmp_path / "ring").glob("*.mcap")
    assert content(segment)[0][OUT]


def test_a_recorder_that_stands_still_costs_no_command_and_is_said(tmp_path, monkeypatch):
    monkeypatch.setattr(recorder_link, "_SLOW", SECOND // 2)
    with recorded_drive(tmp_path) as drive:
        run_until(drive, lambda: list((tmp_path / "ring").glob("*.mcap")), every_step=drive.be_slow)
        os.kill(drive.recorder.process.pid, signal.SIGSTOP)

        def flood():
            for _ in range(500):
                drive.be_slow()

        run_until(drive, drive.link.statuses, every_step=flood)
        assert "reads nothing" in drive.link.statuses()[0].message
        former = len(drive.driven)
        flood()
        assert len(drive.driven) == former + 500
        os.kill(drive.recorder.process.pid, signal.SIGCONT)
        run_until(drive, lambda: not drive.link.statuses())


def test_nobody_else_may_enter_what_the_recorder_makes_so_the_next_guard_begins(tmp_path):
    state = tmp_path / "rtron" / "app"
    with recorded_drive(state / "incidents") as drive:
        drive_into_incident(state / "incidents", drive)
    os.close(open_own_folder(state, ""))
    made = [state.parent, state, *state.rglob("*")]
    folders = [each for each in made if each.is_dir()]
    assert [each for each in folders if each.stat().st_mode & 0o077] == []
