"""What a scan tells people of places: from the app's own folder."""

from pathlib import Path

from rtron.vocabulary import (
    Direction,
    Endpoint,
    Evidence,
    InteractionGraph,
    UnresolvedItem,
    WiringFact,
    WiringFactKind,
)
from rtron.workflows.scan import with_relative_evidence


def test_places_in_the_app_are_told_from_its_folder_and_others_as_they_are():
    places = (Evidence(file="/ws/src/a.py", line=1), Evidence(file="/opt/b.py", line=2))
    graph = InteractionGraph(
        app="app",
        endpoints=(Endpoint(node="/n", topic="/t", direction=Direction.PUBLISH, evidence=places),),
        unresolved=(UnresolvedItem(what="x", why="y", evidence=places),),
        wiring=(WiringFact(kind=WiringFactKind.UNREAD_PUBLISHER, subject="/t", evidence=places),),
    )
    told = with_relative_evidence(graph, Path("/ws"))
    for (part,) in (told.endpoints, told.unresolved, told.wiring):
        assert [each.file for each in part.evidence] == ["src/a.py", "/opt/b.py"]
    assert with_relative_evidence(graph, None) == graph
