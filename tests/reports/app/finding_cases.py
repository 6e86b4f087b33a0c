"""Findings to report."""

from rtron.findings.rule import make_finding
from rtron.vocabulary import Certainty, Consequence, Evidence, Ignore, Triage

PLACES = tuple(Evidence(file=f"src/{name}.py", line=7) for name in ("nav", "teleop", "joy"))


def finding(subject="/cmd_vel", **keys):
    defaults = {
        "summary": f"/nav and /teleop both drive the robot on {subject}",
        "cause": "no arbiter stands between them: /base obeys whoever published last",
        "remedy": f"put a GRCN before {subject}: `rtron plan` proposes it",
        "consequence": Consequence.MOTION,
        "certainty": Certainty.CERTAIN,
        "evidence": PLACES,
    }
    return make_finding("several_publishers", subject, **defaults | keys)


HIGH = finding()
MEDIUM = finding("/arm", certainty=Certainty.POSSIBLE)
LOW = finding("/lost", consequence=Consequence.FAILURE, certainty=Certainty.POSSIBLE)

IGNORE = Ignore(
    rule="several_publishers",
    topic="/arm",
    reason="one of them is a [test] rig",
    place=Evidence(file="rtron.toml", line=3),
)
UNUSED = Ignore(rule="no_server", reason="x", place=Evidence(file="a.py", line=9), is_comment=True)
TRIAGE = Triage(
    findings=(HIGH,),
    known=(LOW,),
    ignored=((MEDIUM, IGNORE),),
    gone=("no_server:/plan",),
    unused=(UNUSED,),
)
