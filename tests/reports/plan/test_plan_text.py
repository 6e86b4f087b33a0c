from dataclasses import replace

from rtron.planning.problem import PlanProblem
from rtron.reports.plan.plan_text import plan_text
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    SECOND,
    Area,
    Audit,
    CommanderRank,
    Domain,
    EventFlow,
    Flow,
    FpsMonitor,
    FrameSource,
    GuardedTopic,
    LeaseGroup,
    MissionRule,
    Mode,
    OnError,
    OnForeign,
    OnSilence,
    Plan,
    Point,
    PolicyName,
    Sharing,
    StopButton,
    StopProfile,
    StopSources,
    StreamKind,
    Supervision,
    Transform,
    WatchedFlow,
    WhenUnknown,
)

PLAN = Plan(
    app="autorace",
    revision=3,
    grcn=(
        GRCN(
            id="grcn_cmd_vel",
            topic="/cmd_vel",
            type="geometry_msgs/Twist",
            domain=Domain.CONTROL,
            kind=StreamKind.COMMAND,
            sharing=Sharing.CONTEND,
            mode=Mode.ENFORCE,
            policy=PolicyName.PRIORITY_QUEUE,
            flows=(
                Flow(name="flow1", publisher="/lane", priority=2, timeout=SECOND // 5),
                Flow(
                    name="flow2",
                    publisher="/parking_*",
                    priority=1,
                    block=True,
                    silent_after=2 * SECOND,
                    on_error=OnError.DROP,
                ),
            ),
            successors=("/base", "/odometry"),
        ),
        GRCN(
            id="grcn_tf",
            topic="/tf",
            type="tf2_msgs/TFMessage",
            domain=Domain.PERCEPTION,
            kind=StreamKind.STATE,
            sharing=Sharing.MERGE,
            mode=Mode.OBSERVE,
            policy=PolicyName.BLOCK,
            flows=(Flow(name="flow1", publisher="/amcl"),),
        ),
    ),
    rsrcn=RSRCN(
        id="rsrcn",
        mode=Mode.OBSERVE,
        policy=PolicyName.SAFE_CONSTRAIN,
        threshold=0.02,
        max_vel_limit=0.22,
        vflows=(
            GuardedTopic(
                topic="/max_vel",
                type="std_msgs/Float64",
                flows=(Flow(name="vflow1", publisher="/detect"),),
                successors=("/lane",),
            ),
        ),
        iflows=(WatchedFlow(name="iflow1", topic="/detect/lane", publisher="/detect"),),
    ),
    msrcn=MSRCN(
        id="msrcn",
        mode=Mode.OBSERVE,
        policy=PolicyName.BLOCK,
        aflows=(
            GuardedTopic(
                topic="/goal",
                type="geometry_msgs/PoseStamped",
                flows=(
                    Flow(name="aflow1", publisher="/search", on_silence=OnSilence.RELEASE),
                    Flow(name="aflow2", publisher="/user"),
                ),
            ),
        ),
        eflows=(
            EventFlow(
                name="low",
                topic="/battery",
                publisher="/base",
                when="event.percentage\n  < 0.2",
                on_silence=WhenUnknown.KEEP,
            ),
            EventFlow(
                name="sign",
                topic="/detect/sign",
                publisher="/detect",
                when="event.data == 3",
                present=2 * SECOND,
            ),
            EventFlow(name="blind", topic="/scan", publisher="/lidar", silent=SECOND // 2),
        ),
        rules=(
            MissionRule(
                name="recharge",
                when="low && !blind",
                block=("/goal", "aflow1"),
                require="/alert",
                reason="The robot must recharge\nwhen its battery is low.",
            ),
            MissionRule(
                name="keep_out",
                block=("/goal",),
                action="inside(action.pose.position, kitchen)",
                frame="map",
            ),
        ),
        areas=(Area(name="kitchen", frame="map", polygon=(Point(x=0, y=0),) * 4),),
        transforms=(Transform(source="odom", target="map", x=1.5, yaw=0.25),),
    ),
    fps_monitor=(
        FpsMonitor(
            id="fps_monitor_detect",
            node="/detect",
            topic="/detect/lane",
            source=FrameSource.DETECTIONS,
            silent_after=SECOND // 2,
            camera=WatchedFlow(name="camera", topic="/camera/image", publisher="/camera"),
        ),
        FpsMonitor(id="fps_monitor_sign", node="/sign", topic="/sign/image"),
    ),
    stop=StopProfile(decel=1.0),
    audit=Audit(period=SECOND // 20, on_foreign=OnForeign.ALARM),
    supervision=Supervision(kill_after=2 * SECOND),
)

AT_80_COLUMNS = """\
autorace  plan for ROS 1, revision 3
GRCN 2 (1 enforce), RSRCN 1, MSRCN 1, fps_monitor 2

grcn_cmd_vel  GRCN  Priority_Queue  enforce
  /cmd_vel  geometry_msgs/Twist, Control, contend
  flow1       /lane           pass   priority 2, timeout 0.2 s
  flow2       /parking_*      block  priority 1, stop when silent for 2 s, no stop on errors
  unapproved  any other node  block
  to          /base
              /odometry

rsrcn  RSRCN  Safe+Constrain  observe
  threshold 0.02 m/frame, max_vel_limit 0.22 m/s, 0 m/s while an image node is
  silent
  /max_vel  std_msgs/Float64
    vflow1  /detect  pass
    to      /lane
  iflow1  /detect  watched on /detect/lane

msrcn  MSRCN  Block  observe
  /goal  geometry_msgs/PoseStamped
    aflow1  /search  pass  no stop when silent
    aflow2  /user    pass
  low  /base  event on /battery
    set while event.percentage < 0.2; when silent: keep
  sign  /detect  event on /detect/sign
    set for 2 s after a message with event.data == 3
  blind  /lidar  event on /scan
    set after 0.5 s without a message
  rule recharge
    while low && !blind: block /goal, aflow1 until /alert has spoken
    The robot must recharge when its battery is low.
  rule keep_out
    block /goal where inside(action.pose.position, kitchen)
  area  kitchen  4 corners in map
  odom lies in map at 1.5 m, 0 m, 0.25 rad

GRCN that only observe (1)
  /tf  Perception  Block  1 flow

fps_monitor (2)
  /detect  on  /detect/lane
    counts detections only, over 1 s, no faster than /camera/image of /camera, silent after 0.5 s
  /sign  on  /sign/image
    counts frames over 1 s

Stop
  a ramp of 1 m/s2 and 3.2 rad/s2, every 0.05 s, at rest within 1 s, then zeros for 1 s

Audit
  every 0.05 s; a foreign publisher: alarm

Supervision
  no sign of life: stop after 0.03 s, kill after 2 s; deliver within 0.5 s, audit 10 s, start 20 s

Left out (1)
  warning  /odd
           it has no type

Next
  rtron instrument APP.launch --plan rtron.yaml -o guarded.launch
"""


def test_at_80_columns(printed):
    next_step = "rtron instrument APP.launch --plan rtron.yaml -o guarded.launch"
    assert (
        printed(plan_text(PLAN, [next_step], [PlanProblem("warning", "/odd", "it has no type")]))
        == AT_80_COLUMNS
    )


def test_an_empty_plan(printed):
    assert printed(plan_text(Plan(app=""))) == (
        "This plan guards nothing: none of its coordination nodes stands in a flow.\n"
        "app  plan for ROS 1, revision 0\nGRCN 0 (0 enforce), RSRCN 0, MSRCN 0, fps_monitor 0\n"
    )


def test_hostile_names_do_nothing(printed):
    name = "/\x1b[2J[bold]\n"
    monitor = FpsMonitor(id=name, node=name, topic=name)
    guarded = GuardedTopic(topic=name, type=name, flows=(Flow(name=name, publisher=name),))
    msrcn = MSRCN(id=name, mode=Mode.OBSERVE, policy=PolicyName.BLOCK, aflows=(guarded,))
    text = printed(plan_text(Plan(app=name, msrcn=msrcn, fps_monitor=(monitor,)), [name]))
    assert "\x1b" not in text
    assert text.count("/\\x1b[2J[bold]\\n") == 9


def test_the_goals_of_an_action_stand_for_all_of_its_topics(printed):
    topic = GuardedTopic(topic="/act/goal", type="p/GoActionGoal", flows=())
    msrcn = MSRCN(id="msrcn", mode=Mode.ENFORCE, policy=PolicyName.BLOCK, aflows=(topic,))
    text = printed(plan_text(Plan(app="app", msrcn=msrcn)))
    assert "  with cancel, status, feedback, result: /act is one action\n" in text


def test_leases_ranks_and_stop_sources_are_told(printed):
    (base, tf) = PLAN.grcn
    flows = (replace(base.flows[0], rank=CommanderRank.OPERATOR_ON_SITE),)
    leased = replace(base, policy=PolicyName.LEASE, lease="base", flows=flows)
    button = StopButton(name="red", topic="/estop", publisher="/estop_driver")
    plan = replace(
        PLAN,
        grcn=(leased, tf),
        leases=(LeaseGroup(name="base"),),
        stop_sources=StopSources(buttons=(button,), second_person=60 * SECOND),
    )
    text = printed(plan_text(plan))
    for told in (
        "rank operator_on_site, priority 2",
        "Leases (1)",
        "base  for /cmd_vel; it ends 5 s after it was renewed last",
        "red  /estop_driver on /estop",
        "a second person must release each stop within 60 s",
    ):
        assert told in text
    assert "Leases" not in printed(plan_text(PLAN))
    assert "Stop sources" not in printed(plan_text(PLAN))


OTHER = PlanProblem("warning", "GRCN a", "who sends?")


def test_what_is_said_of_several_places_is_told_once(printed):
    places = (("warning", "GRCN a"), ("warning", "GRCN b"), ("error", "GRCN c"))
    doubts = [PlanProblem(level, place, "who obeys?") for level, place in places]
    text = printed(plan_text(Plan(app="x", ros=1), doubts=[*doubts[:1], OTHER, *doubts[1:]]))
    assert [row.strip() for row in text.splitlines()[-8:]] == [
        "To decide (4)",
        "warning  GRCN a",
        "GRCN b",
        "who obeys?",
        "warning  GRCN a",
        "who sends?",
        "error    GRCN c",
        "who obeys?",
    ]
