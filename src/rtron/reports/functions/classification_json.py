"""A classification as JSON."""

from rtron.functions.classification import Classification


def classification_to_json(classification: Classification) -> dict[str, object]:
    """Return a repository's functions, what decided them, and the evidence."""
    return {
        "repo": classification.repo,
        "functions": list(map(str, classification.functions)),
        "primary": str(classification.primary) if classification.primary else None,
        "decided_by": str(classification.decided_by),
        "evidence": [
            {
                "piece": str(each.piece),
                "rule": each.rule,
                "type": str(each.type),
                "text": each.text,
                "package": each.package,
            }
            for each in classification.evidence
        ],
    }
