"""`rtron schema`."""

from enum import Enum
from typing import TYPE_CHECKING, Annotated, Any

import typer

from rtron.cli.support.outcome import Outcome, as_json

if TYPE_CHECKING:
    from collections.abc import Callable


class Document(str, Enum):
    """A document that RTron reads."""

    PLAN = "plan"
    GRAPH = "graph"
    CONFIG = "config"


def schema(
    document: Annotated[Document, typer.Argument(help="The document to describe.")],
) -> Outcome:
    """Print the JSON Schema of a plan, a graph, or a configuration.

    These are rtron.yaml, graph.json and rtron.toml. Give the schema to your
    editor: it then completes and checks the file while you write. A plan that
    `rtron plan` proposes names its schema, and editors with the YAML language
    server find it.

    $ rtron schema plan > rtron.schema.json
    """
    from rtron.planning.plan_file.json_schema import plan_json_schema
    from rtron.sources.graph_json import graph_json_schema
    from rtron.sources.ignores.config_file import config_json_schema
    from rtron.workflows.scan import RULE_NAMES

    schemas: dict[Document, Callable[[], dict[str, Any]]] = {
        Document.PLAN: plan_json_schema,
        Document.GRAPH: graph_json_schema,
        Document.CONFIG: lambda: config_json_schema(RULE_NAMES),
    }
    return Outcome(as_json(schemas[document]()))
