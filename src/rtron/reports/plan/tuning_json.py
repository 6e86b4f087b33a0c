"""What a measured run proposes for a plan, as JSON for other programs."""

from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from rtron.vocabulary import PROPOSALS_SCHEMA, SECOND, Proposal, Run


def tuning_to_json(run: Run, proposals: Sequence[Proposal]) -> dict[str, Any]:
    """Return the proposals as a document; values are written as in the plan."""
    return {
        "schema": PROPOSALS_SCHEMA,
        "app": run.app,
        "duration": run.duration / SECOND,
        "proposals": [asdict(each) for each in proposals],
    }
