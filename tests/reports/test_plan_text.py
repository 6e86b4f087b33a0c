from rtron.reports.plan_text import plan_text
from rtron.reports.problems_text import Remark
from rtron.vocabulary import (
    GRCN,
    MSRCN,
    RSRCN,
    SECOND,
    Domain,
    Flow,
    FpsMonitor,
    GuardedTopic,
    Mode,
    Plan,
    PolicyName,
    Sharing,
    StreamKind,
    WatchedFlow,
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
                Flow(name="flow2", publisher="/parking_*", priority=1, block=True),
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
        policy=PolicyName.CONSTRAIN,
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
        eflows=(WatchedFlow(name="eflow1", topic="/detect/sign", publisher="/detect"),),
    ),
    fps_monitor=(FpsMonitor(id="fps_monitor_detect", node="/detect", topic="/detect/lane"),),
)

AT_80_COLUMNS = """\
autorace  plan for ROS 1, revision 3
GRCN 2 (1 enforce), RSRCN 1, MSRCN 1, fps_monitor 1

grcn_cmd_vel  GRCN  Priority_Queue  enforce
  /cmd_vel  geometry_msgs/Twist, Control, contend
  flow1       /lane           pass   priority 2, timeout 0.2 s
  flow2       /parking_*      block  priority 1
  unapproved  any other node  block
  to          /base
              /odometry

rsrcn  RSRCN  Constrain  observe
  /max_vel  std_msgs/Float64
    vflow1  /detect  pass
    to      /lane
  iflow1  /detect  watched on /detect/lane

msrcn  MSRCN  Block  observe
  eflow1  /detect  watched on /detect/sign

GRCN that only observe (1)
  /tf  Perception  Block  1 flow

fps_monitor (1)
  /detect  on  /detect/lane

Left out (1)
  warning  /odd
           it has no type

Next
  rtron instrument APP.launch --plan rtron.yaml -o guarded.launch
"""


def test_at_80_columns(printed):
    next_step = "rtron instrument APP.launch --plan rtron.yaml -o guarded.launch"
    assert (
        printed(plan_text(PLAN, next_step, [Remark("warning", "/odd", "it has no type")]))
        == AT_80_COLUMNS
    )


def test_an_empty_plan(printed):
    assert printed(plan_text(Plan(app=""))) == (
        "app  plan for ROS 1, revision 0\nGRCN 0 (0 enforce), RSRCN 0, MSRCN 0, fps_monitor 0\n"
    )


def test_hostile_names_do_nothing(printed):
    name = "/\x1b[2J[bold]\n"
    monitor = FpsMonitor(id=name, node=name, topic=name)
    guarded = GuardedTopic(topic=name, type=name, flows=(Flow(name=name, publisher=name),))
    msrcn = MSRCN(id=name, mode=Mode.OBSERVE, policy=PolicyName.BLOCK, aflows=(guarded,))
    text = printed(plan_text(Plan(app=name, msrcn=msrcn, fps_monitor=(monitor,)), name))
    assert "\x1b" not in text
    assert text.count("/\\x1b[2J[bold]\\n") == 9
