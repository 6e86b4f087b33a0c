"""`rtron schema`."""

from enum import Enum
from typing import Annotated

import typer

from rtron.cli.support.outcome import Outcome, as_json


class Document(str, Enum):
    """A document that RTron reads."""

    PLAN = "plan"
    GRAPH = "graph"


def schema(
    document: Annotated[Document, typer.Argument(help="The document to describe.")],
) -> Outcome:
    """Print the JSON Schema of a plan or a graph.

    Give it to your editor: it then completes and checks rtron.yaml while you
    write.

    $ rtron schema plan > rtron.schema.json
    """
    from rtron.planning.plan_file.json_schema import plan_json_schema
    from rtron.sources.graph_json import graph_json_schema

    is_plan = document is Document.PLAN
    return Outcome(as_json(plan_json_schema() if is_plan else graph_json_schema()))
