"""How severe a risk is: what it can reach, and whether a node that could do it is untrusted.

| what is at stake                                             | untrusted | all own |
|--------------------------------------------------------------|-----------|---------|
| GR on a contending topic of Planning or Control              | high      | medium  |
| RSR max_vel, MSR action                                      | high      | medium  |
| GR elsewhere or where publishers merge, RSR image, MSR event | medium    | low     |
| any of these, while no node of the app acts on it            | low       | low     |

A node is untrusted unless its package is your own (paper sections 2.3 and 4.1).
"""

from rtron.vocabulary import Domain, Severity, Sharing, TopicClass


def severity_of(*, moves_robot: bool, only_own_nodes: bool, reaches_successor: bool) -> Severity:
    """Return how bad a risk is.

    `moves_robot`: it moves the robot at once. `only_own_nodes`: only the user's own nodes cause
    it. `reaches_successor`: a node obeys it.
    """
    if not reaches_successor:
        return Severity.LOW
    if moves_robot:
        return Severity.MEDIUM if only_own_nodes else Severity.HIGH
    return Severity.LOW if only_own_nodes else Severity.MEDIUM


def contends_for_robot(topic: TopicClass) -> bool:
    """Tell whether publishers of a topic take turns in planning for or controlling the robot."""
    moves_robot = topic.domain in (Domain.PLANNING, Domain.CONTROL)
    return moves_robot and topic.sharing is Sharing.CONTEND
