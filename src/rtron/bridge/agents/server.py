"""Running an agent's server: the Model Context Protocol over standard input and output."""

import os
from collections.abc import AsyncIterator
from contextlib import asynccontextmanager
from pathlib import Path

from rtron import __version__
from rtron.bridge.agents.app_client import AppClient
from rtron.bridge.agents.tools import INSTRUCTIONS, AgentTools
from rtron.bridge.known_types import known_types
from rtron.errors import InputError
from rtron.messages import VELOCITY_TYPES
from rtron.vocabulary import (
    BRIDGE_ROOT,
    CommanderRank,
    InteractionGraph,
    Mode,
    Plan,
    PolicyName,
    Stream,
    build_streams,
    normalise_type,
)
from rtron.workflows.scan import scan_graph

TOKEN_VARIABLE = "RTRON_BRIDGE_TOKEN"  # noqa: S105 - where it is, not what it is


def run_agent_server(
    plan: Plan, name: str, address: str, token: str, graph: InteractionGraph | None
) -> None:
    """Serve one agent on standard input and output until its end.

    InputError if the plan lets the agent command without a lease, or the library is missing.
    """
    try:
        from mcp.server import MCPServer  # noqa: PLC0415 - the extra `mcp`
    except ImportError:
        raise InputError("the library mcp is not here", help='pip install "rtron[mcp]"') from None
    node = f"{BRIDGE_ROOT}/{name}"
    check_agent(plan, node)
    app = AppClient(plan, node, known_types(plan), address, token)
    risks = scan_graph(graph).report if graph else None
    tools = AgentTools(app, graph, risks)

    @asynccontextmanager
    async def lifespan(_server: object) -> AsyncIterator[None]:
        try:
            yield
        finally:
            await tools.close()

    server = MCPServer(
        "rtron",
        version=__version__,
        instructions=INSTRUCTIONS,
        lifespan=lifespan,
        log_level="ERROR",
    )
    for tool in tools.all:
        server.add_tool(tool, structured_output=False)
    server.run("stdio")


def check_agent(plan: Plan, node: str) -> None:
    """Raise an InputError if an agent's node may command without a lease, or above its rank."""
    problems = [
        problem
        for stream in build_streams(plan)
        if stream.mode is Mode.ENFORCE and normalise_type(stream.type) in VELOCITY_TYPES
        for problem in _problems(stream, node)
    ]
    if problems:
        help = "docs/leases.md shows a plan with leases"
        raise InputError("\n".join(problems), help=help)


def read_token(path: Path | None) -> str:
    """Return the agent's token: from a file, else from the environment; InputError if none."""
    if path:
        try:
            return path.read_text(encoding="utf-8").strip()
        except (OSError, ValueError) as error:
            raise InputError(f"{path}: {error}") from None
    token = os.environ.get(TOKEN_VARIABLE, "")
    if not token:
        help = "`rtron bridge token NAME` makes one"
        raise InputError(f"set {TOKEN_VARIABLE}, or name a file with --token-file", help=help)
    return token


def _problems(stream: Stream, node: str) -> list[str]:
    own = [flow for flow in stream.flows if flow.publisher == node]
    problems = [
        f"{stream.topic}: {node} is {flow.rank}, an agent has the rank agent"
        for flow in own
        if flow.rank is not CommanderRank.AGENT
    ]
    if own and stream.stages[0].settings.policy is not PolicyName.LEASE:
        problems.append(f"{stream.topic}: {node} would command without a lease")
    return problems
