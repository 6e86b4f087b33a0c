"""The report of the cases: one page that needs nothing else."""

from base64 import b64encode
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from string import Template

from rich.text import Text

from rtron.demos.cases import Case
from rtron.demos.metrics.case_run import CaseRun
from rtron.demos.metrics.table import COLUMN_TITLES, cells, columns
from rtron.demos.runtime.processes import CompletedCommand
from rtron.reports.inline_page import policy
from rtron.sanitize import sanitize

_STYLE = """
body { font: 16px/1.5 system-ui, sans-serif; color: #1f2430; background: #fff;
  max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
h1 { font-size: 1.6rem; line-height: 1.25; } h2 { font-size: 1.15rem; margin-top: 2.2rem; }
dt { font-weight: 600; } dd { margin: 0 0 .6rem; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; }
th, td { text-align: left; padding: .35rem .9rem .35rem 0; border-bottom: 1px solid #d9dce2; }
td { font-variant-numeric: tabular-nums; }
figure { margin: 1.2rem 0; } img { max-width: 100%; height: auto; }
figcaption { color: #5b6270; font-size: .9rem; }
pre { background: #f2f3f5; padding: .8rem; overflow-x: auto; font-size: .85rem; line-height: 1.4; }
summary { cursor: pointer; } code { font-size: .95em; }
"""
_PAGE = Template("""<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="$policy">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>RTron's case studies</title>
<style>$style</style>
</head>
<body>
$parts
<h1>The commands</h1>
$commands
</body>
</html>
""")
_PART = Template("""<h1>$title</h1>
<dl>$story</dl>
<h2>What came of it</h2>
<p>$conditions</p>
<div class="wide"><table>$table</table></div>
$pictures
$decided
""")
_DECIDED = Template("""<h2>The developer's decisions in the plan</h2>
<p>$remedy</p>
<pre>$decisions</pre>""")


@dataclass(frozen=True, slots=True)
class Picture:
    """The file of a PNG, and what it shows."""

    path: Path
    caption: str


@dataclass(frozen=True, slots=True, kw_only=True)
class CaseFindings:
    """What is told of a case: `decisions` as YAML ("" for none), and the runs in all worlds."""

    case: Case
    ros: int
    runs: Sequence[CaseRun]
    decisions: str
    pictures: Sequence[Picture] = ()


def render_report(cases: Iterable[CaseFindings], commands: Iterable[CompletedCommand]) -> str:
    """Return the page; the commands are those that led to the guarded app.

    All text from outside is escaped, and nothing is loaded from elsewhere.
    """
    shown = "".join(map(_part, cases))
    command_blocks = "".join(map(_command, commands))
    allowed = escape(policy((), _STYLE))
    return _PAGE.substitute(policy=allowed, style=_STYLE, parts=shown, commands=command_blocks)


def _part(found: CaseFindings) -> str:
    return _PART.substitute(
        title=escape(f"{found.case.title} (ROS {found.ros})"),
        story=_story(found.case),
        conditions=escape(_conditions(found.runs)),
        table=_table(found.runs),
        pictures="".join(map(_picture, found.pictures)),
        decided=_decisions_html(found) if found.decisions else "",
    )


def _decisions_html(found: CaseFindings) -> str:
    return _DECIDED.substitute(remedy=escape(found.case.remedy), decisions=escape(found.decisions))


def _story(case: Case) -> str:
    parts = {"The attack": case.attack, "The harm": case.harm_description}
    return "".join(_cell("dt", name) + _cell("dd", text) for name, text in parts.items())


def _conditions(runs: Sequence[CaseRun]) -> str:
    seeds = ", ".join(map(str, dict.fromkeys(run.seed for run in runs)))
    speeds = ", ".join(dict.fromkeys(f"{run.speed:g}" for run in runs))
    return f"Worlds (seeds): {seeds}. Simulated seconds a second: {speeds}."


def _table(runs: Sequence[CaseRun]) -> str:
    table = columns(runs)
    head = "".join(_cell("th", COLUMN_TITLES[variant]) for variant in table)
    lines = (_cell("th", title) + _all("td", values) for title, values in cells(table))
    return f"<tr><th></th>{head}</tr>" + "".join(f"<tr>{line}</tr>" for line in lines)


def _all(tag: str, values: Iterable[str]) -> str:
    return "".join(_cell(tag, value) for value in values)


def _cell(tag: str, text: str) -> str:
    return f"<{tag}>{escape(text)}</{tag}>"


def _picture(picture: Picture) -> str:
    data, caption = b64encode(picture.path.read_bytes()).decode(), escape(picture.caption)
    image = f'<img alt="{caption}" src="data:image/png;base64,{data}">'
    return f"<figure>{image}<figcaption>{caption}</figcaption></figure>\n"


def _command(ran: CompletedCommand) -> str:
    text = "\n".join(map(sanitize, Text.from_ansi(ran.text).plain.splitlines()))
    summary = f"<summary><code>$ {escape(sanitize(ran.command))}</code></summary>"
    return f"<details>{summary}<pre>{escape(text)}</pre></details>\n"
