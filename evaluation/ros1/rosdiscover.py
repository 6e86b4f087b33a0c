"""What ROSDiscover reports for the same apps.

Node models (RQ1): results/RQ1.csv of cmu-rss-lab/rosdiscover-evaluation at 4648ad9. Systems: the
recovered.architecture.yml there, scored over all nodes against observed.architecture.yml as
`evaluation.ros1.architecture` does it; the authors' own counts without their ignore list agree.
"""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class PeerScore:
    """Precision and recall under the ignore list, and recall without it where it was scored."""

    precision: float
    recall: float
    raw_recall: float | None = None


SYSTEMS: Mapping[str, Mapping[str, PeerScore]] = {
    "autorally": {
        "nodes": PeerScore(0.917, 1.0),
        "publishers": PeerScore(1.0, 1.0, 0.5),
        "subscribers": PeerScore(0.966, 1.0, 0.644),
        "services": PeerScore(0.974, 1.0, 0.587),
    },
    "turtlebot": {
        "nodes": PeerScore(0.857, 0.923),
        "publishers": PeerScore(0.949, 0.881, 0.5),
        "subscribers": PeerScore(0.929, 0.839, 0.481),
        "services": PeerScore(1.0, 0.971, 0.576),
    },
}

AUTOWARE_CALLS_UNKNOWN = 14.5
"""API calls of Autoware.AI 1.10 with an unresolved argument, %, of 882.

The 882 are the statements of its node models that are calls: 185 `ros::init`, the rest mostly
publishers, subscribers and services. Parameter reads stand inside assignments and are not counted
(a note in scripts/recover-node-models.py says so).
"""
AUTOWARE_NODES_TOUCHED = 32.1
"""Nodes of Autoware.AI 1.10 with such a call, %, of 209."""
