"""A small app and its risks to report."""

from rtron.vocabulary import (
    CoordinationCount,
    Direction,
    Domain,
    Endpoint,
    Evidence,
    InteractionGraph,
    Node,
    Risk,
    RiskKind,
    RiskReport,
    RiskRole,
    Severity,
    Sharing,
    Topic,
    TopicClass,
    Trust,
    UnresolvedItem,
)

CMD_VEL, SIGN = "/cmd_vel", "/detect/sign"


def speaks(node, topic, **keys):
    return Endpoint(node=node, topic=topic, direction=Direction.PUBLISH, **keys)


def hears(node, topic, **keys):
    return Endpoint(node=node, topic=topic, direction=Direction.SUBSCRIBE, **keys)


def risk(kind, **keys):
    defaults = {
        "id": f"{kind}:1",
        "kind": kind,
        "rule": kind.value.lower().replace("-", "_"),
        "role_nodes": {},
        "topics": (CMD_VEL,),
        "message_type": "geometry_msgs/Twist",
        "successors": ("/base",),
        "domain": Domain.CONTROL,
        "severity": Severity.LOW,
        "reason": "because",
    }
    return Risk(**defaults | keys)


def report_of(*risks, grcn=None, **keys):
    count = CoordinationCount(grcn=grcn or {Domain.CONTROL: 1}, fps_monitor=2, rsrcn=1, msrcn=1)
    return RiskReport(app="autorace", risks=risks, coordination_nodes=count, **keys)


CONTENDED = risk(
    RiskKind.GR_ST,
    role_nodes={RiskRole.PUBLISHER: ("/lane", "/parking", "/teleop")},
    severity=Severity.HIGH,
    reason="/lane, /parking and /teleop all publish /cmd_vel",
    evidence=tuple(Evidence(file=f"src/{i}.py", line=i) for i in range(1, 6)),
)
EVENT = risk(
    RiskKind.MSR,
    id=f"MSR-event:{SIGN}",
    role_nodes={RiskRole.EVENT: ("/detect",)},
    topics=(SIGN,),
    message_type="std_msgs/UInt8",
    successors=("/lane",),
    domain=Domain.PERCEPTION,
)
ACTION = risk(
    RiskKind.MSR,
    id=f"MSR-action:{CMD_VEL}",
    role_nodes={RiskRole.ACTION: ("/lane", "/teleop")},
    severity=Severity.MEDIUM,
    reason="/lane and others make the robot act through /cmd_vel: /base obeys, whatever happens",
    evidence=(Evidence(file="src/lane.py", line=7), Evidence(file="src/teleop.py", line=9)),
)
REPORT = report_of(
    EVENT,
    CONTENDED,
    ACTION,
    not_run={"rsr_image": "the graph holds no message types"},
    topic_classes={CMD_VEL: TopicClass(domain=Domain.CONTROL, sharing=Sharing.CONTEND)},
)
GRAPH = InteractionGraph(
    app="autorace",
    nodes=(
        Node(name="/lane", trust=Trust.OWN),
        Node(name="/parking", trust=Trust.OWN),
        Node(name="/teleop", trust=Trust.THIRD_PARTY),
        Node(name="/detect"),
        Node(name="/base"),
    ),
    topics=tuple(Topic(name=name) for name in (CMD_VEL, SIGN, "/camera/image", "/rosout")),
    endpoints=(
        speaks("/lane", CMD_VEL),
        speaks("/parking", CMD_VEL),
        speaks("/teleop", CMD_VEL),
        hears("/base", CMD_VEL),
        hears("/detect", "/camera/image"),
        speaks("/detect", SIGN),
        hears("/lane", SIGN),
        speaks("/lane", "/rosout", implicit=True),
    ),
    unresolved=(
        UnresolvedItem(
            what="a publisher of /odd",
            why="its name comes from a service call",
            evidence=(Evidence(file="src/odd.cpp", line=12),),
        ),
    ),
)
