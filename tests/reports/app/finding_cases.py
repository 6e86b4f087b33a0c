"""Findings to report."""

from rtron.findings.rule import make_finding
from rtron.vocabulary import Certainty, Consequence, Evidence

PLACES = tuple(Evidence(file=f"src/{name}.py", line=7) for name in ("nav", "teleop", "joy"))


def finding(subject="/cmd_vel", **keys):
    defaults = {
        "summary": f"/nav and /teleop both drive the robot on {subject}",
        "cause": "nothing decides between them: /base obeys whoever published last",
        "remedy": f"put a GRCN before {subject}: `rtron plan` proposes it",
        "consequence": Consequence.MOTION,
        "certainty": Certainty.CERTAIN,
        "evidence": PLACES,
    }
    return make_finding("several_publishers", subject, **defaults | keys)


HIGH = finding()
MEDIUM = finding("/arm", certainty=Certainty.POSSIBLE)
LOW = finding("/lost", consequence=Consequence.FAILURE, certainty=Certainty.POSSIBLE)
