"""An incident that the recorder has saved of a drive in memory, at once and without a process."""

from guarded_drive import ALLOWED, Drive, speed_plan

from rtron.guard.incidents.entries import RecorderTask, RevisionChanged
from rtron.guard.incidents.recorder import IncidentRecorder
from rtron.guard.incidents.stream_notes import StreamNotes, observed_state
from rtron.vocabulary import SECOND, Settings
from rtron.wire.common.incident_format import encode_settings

START = 100 * SECOND
WALL = 1_800_000_000 * SECOND


def saved_incident(
    folder, speeds, plan=None, period=SECOND // 20, settings=None, changed=None, noted=()
):
    """Drive at each of the speeds for a period; return the file of the incident, None if none.

    Where the plan has rules, /amcl says where the robot is. `changed` are settings that are noted,
    `noted` other entries of the beginning.
    """
    plan = plan or speed_plan(keep=60 * SECOND, after=60 * SECOND)
    drive = Drive(plan, START)
    notes = StreamNotes(drive.host, drive.transport.now, 1 << 24)
    notes.open()
    task = RecorderTask(plan, encode_settings(settings or Settings()), str(folder))
    recorder = IncidentRecorder.open(task, lambda: WALL)
    if changed:
        change = RevisionChanged(START, changed.revision, encode_settings(changed))
        recorder.add((change,), START)
    recorder.add(tuple(noted), START)
    driven = 0.0
    for speed in speeds:
        if plan.msrcn:
            drive.be_at(driven)
        observed = observed_state(drive.host.observations, drive.transport.now())
        recorder.add((observed,), drive.transport.now())
        if speed is not None:
            drive.command(speed)
            driven += min(speed, ALLOWED) * period / SECOND
        recorder.add(tuple(notes.take(1 << 24)), drive.transport.now())
        drive.transport.advance(period)
    recorder.add(tuple(notes.take(1 << 24)), drive.transport.now())
    recorder.close(drive.transport.now())
    return next(iter(sorted(folder.glob("*.mcap"))), None)
