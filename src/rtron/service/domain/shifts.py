"""What people of one shift tell each other: alarms that somebody has seen, and handover notes."""

from typing import Annotated

from pydantic import AfterValidator, BaseModel, Field, StringConstraints

from rtron.service.domain.alarms import MAX_TEXT, Acknowledgement, AlarmKey, clean_key, without_nul
from rtron.service.domain.schemas import Name, RequestModel, RequiredReason

MAX_ALARMS = 200
"""So many alarms are acknowledged by one request."""

_Text = Annotated[str, StringConstraints(max_length=MAX_TEXT)]


class AlarmReference(RequestModel):
    """An alarm of a robot, by what tells it from another."""

    robot: Name
    kind: str = Field(max_length=40)
    topic: _Text = ""
    node: _Text = ""
    peer: _Text = ""

    @property
    def key(self) -> AlarmKey:
        """What tells it from the robot's other alarms."""
        return clean_key(self.kind, self.topic, self.node, self.peer)


class AcknowledgeRequest(RequestModel):
    """Alarms that somebody has seen, and what there is to say to them."""

    alarms: list[AlarmReference] = Field(min_length=1, max_length=MAX_ALARMS)
    note: RequiredReason


class AcknowledgeResult(BaseModel):
    """How many alarms are acknowledged now, which are none any more, and at which robots not."""

    acknowledged: int
    gone: list[AlarmReference]
    failed: dict[str, str]


class AcknowledgementPage(BaseModel):
    """Acknowledgements, newest first; `next` continues with older ones (`before`)."""

    acknowledgements: list[Acknowledgement]
    next: int | None


class NewHandover(RequestModel):
    """What the next shift is to know."""

    text: Annotated[
        str,
        StringConstraints(strip_whitespace=True, min_length=3, max_length=4000),
        AfterValidator(without_nul),
    ]


class Situation(BaseModel):
    """How many robots there were, and of how many something was the matter."""

    robots: int
    connected: int
    stopped: int
    overridden: int
    alarms: int
    acknowledged: int


class Handover(BaseModel):
    """A handover note: who wrote it, when (ns), and what was so then."""

    id: int
    at: int
    by: str
    text: str
    situation: Situation


class HandoverPage(BaseModel):
    """Handover notes, newest first; `next` continues with older ones (`before`)."""

    handovers: list[Handover]
    next: int | None
