"""How the figures look: one font, and colours that the colour-blind tell apart."""

from contextlib import contextmanager
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from rtron.demos.metrics.case_run import CaseRun, Variant
from rtron.errors import SourceError

if TYPE_CHECKING:
    from collections.abc import Iterator

    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Style = dict[str, Any]
"""Keyword arguments of what is drawn."""
WIDTH = 8.0
"""Of every figure, inches."""
DPI = 160
INK, MUTED, FAINT, GROUND = "#1f2430", "#5b6270", "#d9dce2", "#f2f3f5"
LIMIT, AREA = "#7a3b8f", "#cc79a7"
ATTACK = "#f0c9a8"
COLOURS = {  # of Okabe and Ito
    Variant.UNATTACKED: "#0072b2",
    Variant.ATTACKED: "#d55e00",
    Variant.GUARDED: "#009e73",
}
_ON_ONE_LINE = 5
"""So many entries of a legend have place beside each other."""
_SETTINGS: Any = {
    "font.family": "sans-serif",
    "font.sans-serif": ["DejaVu Sans"],
    "font.size": 10,
    "axes.titlesize": 11,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.labelsize": 10,
    "xtick.labelsize": 9.5,
    "ytick.labelsize": 9.5,
    "legend.fontsize": 9.5,
    "legend.frameon": False,
    "axes.edgecolor": MUTED,
    "axes.labelcolor": INK,
    "axes.titlecolor": INK,
    "text.color": INK,
    "xtick.color": MUTED,
    "ytick.color": MUTED,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.axisbelow": True,
    "grid.color": FAINT,
    "grid.linewidth": 0.7,
    "lines.solid_capstyle": "round",
}


def require_matplotlib() -> None:
    """Raise SourceError if there is nothing to draw with."""
    if find_spec("matplotlib") is None:
        raise SourceError("the figures need matplotlib", help='pip install "rtron[demo]"')


@contextmanager
def figure_file(
    path: Path, height: float, rows: int = 1, *, share_time: bool = True
) -> "Iterator[tuple[Figure, list[Axes]]]":
    """Give a figure of `height` inches and its axes; it is written to `path` at the end.

    It is PNG, or what the file's name ends with. Rows have one axis of time if `share_time`.
    """
    require_matplotlib()
    from matplotlib import rc_context  # noqa: PLC0415 - only with the extra
    from matplotlib.figure import Figure  # noqa: PLC0415

    with rc_context(_SETTINGS):
        figure = Figure(figsize=(WIDTH, height), layout="constrained")
        axes = figure.subplots(rows, 1, squeeze=False, sharex=share_time and rows > 1)
        yield figure, list(axes[:, 0])
        figure.savefig(path, dpi=DPI)


def legend_below(figure: "Figure", axes: "Axes", columns: int) -> None:
    """Put the legend of some axes under the figure, where no data are; each label once."""
    handles, labels = axes.get_legend_handles_labels()
    found = dict(zip(labels, handles, strict=True))
    width = len(found) if len(found) <= _ON_ONE_LINE else columns
    layout: Style = {"loc": "outside lower center", "ncols": width, "columnspacing": 1.6}
    figure.legend(found.values(), found.keys(), **layout)


def shade_attack(axes: "Axes", *runs: CaseRun) -> None:
    """Shade the time in which malicious messages were sent, in any of the runs."""
    spans = [(*run.attack_span, run.ended) for run in runs if run.attack_span]
    if spans:
        began = min(first for first, _, _ in spans)
        ended = max(min(last, over) for _, last, over in spans)
        style: Style = {"color": ATTACK, "alpha": 0.55, "linewidth": 0, "zorder": 0}
        axes.axvspan(began, ended, label="attack", **style)
