"""Reports of incidents without a file: a usual one, and the longest that there can be."""

from rtron.wire.common.incident_report import (
    MAX_ALTERNATIVES,
    MAX_AREAS,
    MAX_CAUSES,
    MAX_CHANGES,
    MAX_CORNERS,
    MAX_EVENTS,
    MAX_FLOWS,
    MAX_NOTES,
    MAX_NUMBER,
    MAX_OWNERS,
    MAX_PLACES,
    MAX_POINTS,
    MAX_SENTENCE,
    MAX_TEXT,
    MAX_TOPICS,
    IncidentReport,
    ReportedAlternative,
    ReportedArea,
    ReportedCause,
    ReportedChange,
    ReportedEvent,
    ReportedFlow,
    ReportedOwner,
    ReportedTopic,
)

AT = 1_800_000_000_000_000_000
NAME = "20270115T080000.000Z-stop-cmd_vel.mcap"
STEP = 0.1
AT_CAUSE = 200


def a_report(name=NAME, text="/teleop", reason="drop: 0.80 m/s is above 0.22 m/s", **values):
    """Return the report of a base that was driven too fast; `text` is the name of who drove it."""
    speeds = (0.2,) * AT_CAUSE + (0.8,) * (MAX_POINTS - AT_CAUSE)
    output = (0.2,) * AT_CAUSE + (0.22,) * (MAX_POINTS - AT_CAUSE)
    verdicts = {"pass": 400, "hold": 0, "drop": 0, "modify": 200}
    flow = ReportedFlow(flow="flow1", publisher=text, verdicts=verdicts, speeds=speeds)
    change = ReportedChange(
        at=0.0, flow="flow1", decision="modify", policy="Constrain", reason=reason
    )
    topic = ReportedTopic(
        topic="/cmd_vel",
        flows=(flow,),
        output=output,
        limits=(0.22,) * MAX_POINTS,
        owners=(ReportedOwner(at=-20.0, owner="flow1", publisher=text, stopping=""),),
        changes=(change,),
        left_out=0,
    )
    alternative = ReportedAlternative(
        title="without the guard",
        sentences=("/cmd_vel: 0.80 m/s instead of 0.22 m/s at +0.00 s; into kitchen after 3.0 s",),
        notes=(),
        outputs={"/cmd_vel": speeds},
        path=tuple((4 + each / 10, 0.5) for each in range(60)),
    )
    cause = ReportedCause(
        at=0.0, kind="intervention", topic="/cmd_vel", flow="flow1", reason=reason
    )
    made = {
        "name": name,
        "size": 1_234_567,
        "at": AT,
        "app": "drive",
        "ros": 2,
        "distribution": "jazzy",
        "rtron": "0.1.0",
        "revision": 3,
        "gravest": cause,
        "owner": "flow1",
        "publisher": text,
        "causes": (cause,),
        "omitted_causes": 0,
        "begin": -AT_CAUSE * STEP,
        "step": STEP,
        "topics": (topic,),
        "omitted_topics": 0,
        "events": (ReportedEvent(at=1.0, kind="alarm", topic="/cmd_vel", reason=reason),),
        "omitted_events": 0,
        "frame": "map",
        "path": tuple((each / 10, 0.5) for each in range(40)),
        "areas": (ReportedArea(name="kitchen", polygon=((6, -1), (8, -1), (8, 2), (6, 2))),),
        "alternatives": (alternative,),
    }
    return IncidentReport(**made | values)


def longest_report(name=NAME):
    """Return a report with as much of everything as there may be, in the longest spelling."""
    number, count, text = -MAX_NUMBER + 0.001, (1 << 53) - 1, "\U0001f916" * MAX_TEXT
    speeds, place = (number,) * MAX_POINTS, (number, number)
    verdicts = dict.fromkeys(("pass", "hold", "drop", "modify"), count)
    flow = ReportedFlow(flow=text, publisher=text, verdicts=verdicts, speeds=speeds)
    owner = ReportedOwner(at=number, owner=text, publisher=text, stopping=text)
    change = ReportedChange(at=number, flow=text, decision=text, policy=text, reason=text)
    topic = ReportedTopic(
        topic=text,
        flows=(flow,) * MAX_FLOWS,
        output=speeds,
        limits=speeds,
        owners=(owner,) * MAX_OWNERS,
        changes=(change,) * MAX_CHANGES,
        left_out=count,
    )
    alternative = ReportedAlternative(
        title=text,
        sentences=("\U0001f916" * MAX_SENTENCE,) * MAX_TOPICS,
        notes=(text,) * MAX_NOTES,
        outputs={f"{text[1:]}{each}": speeds for each in range(MAX_TOPICS)},
        path=(place,) * MAX_PLACES,
    )
    cause = ReportedCause(at=number, kind="intervention", topic=text, flow=text, reason=text)
    return a_report(
        name,
        text,
        text,
        app=text,
        distribution=text,
        rtron=text,
        gravest=cause,
        owner=text,
        causes=(cause,) * MAX_CAUSES,
        topics=(topic,) * MAX_TOPICS,
        events=(ReportedEvent(at=number, kind=text, topic=text, reason=text),) * MAX_EVENTS,
        frame=text,
        path=(place,) * MAX_PLACES,
        areas=(ReportedArea(name=text, polygon=(place,) * MAX_CORNERS),) * MAX_AREAS,
        alternatives=(alternative,) * MAX_ALTERNATIVES,
    )
