"""What the paper reports of the apps that it studied, beside which a survey is shown.

Sources: "Analysis of open-source robot apps" (section 3.3; `rtron.functions.app_categories` has
that table), section 7.1 (risks of the 110 apps), "Numbers of CNs in four complex robot apps"
(section 7.2) and "Processing time of potential risk discovery" (section 7.3). The graph of
functions is a picture without counts.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from rtron.vocabulary import Domain

RSR_APPS = 16
"""Apps that were looked at for RSR: 15 related to images, one to the maximal velocity."""
RSR_RISKS = 24
"""20 related to images, 4 to the maximal velocity."""
RISKS_OF_COMPLEX_APPS = 198


@dataclass(frozen=True, slots=True, kw_only=True)
class ComplexApp:
    """One of the paper's four complex apps: its size, and the coordination nodes that it needs."""

    name: str
    nodes: int
    topics: int
    grcn: Mapping[Domain, int]
    fps_monitor: int


def _complex_app(name: str, size: tuple[int, int], grcn: tuple[int, ...], fps: int) -> ComplexApp:
    domains = (Domain.PERCEPTION, Domain.PLANNING, Domain.CONTROL)
    return ComplexApp(
        name=name,
        nodes=size[0],
        topics=size[1],
        grcn=MappingProxyType(dict(zip(domains, grcn, strict=True))),
        fps_monitor=fps,
    )


COMPLEX_APPS = (
    _complex_app("Home", (21, 125), (8, 3, 1), 2),
    _complex_app("AutoRace", (25, 112), (16, 2, 4), 5),
    _complex_app("Apollo", (21, 39), (4, 1, 1), 3),
    _complex_app("Autoware", (38, 218), (11, 3, 2), 1),
)
"""Each has one RSRCN and one MSRCN besides."""
