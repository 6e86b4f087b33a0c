"""The part of the report of `rtron secure` on Zenoh: what its files let each process do, or not."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from rich.text import Text

from rtron.reports.text_layout import TextPage, heading, line, paragraph

_SHOWN_KEYS = 12
_RESTART = "The router reads its configuration when it starts, and only then: restart it"
_NO_REVOCATION = (
    "Zenoh knows no revocation: whoever has the former key of a process can use it until its "
    "certificate expires. Make a new keystore if it was stolen"
)


@dataclass(frozen=True, slots=True, kw_only=True)
class ZenohReport:
    """Zenoh's files beside graph and plan.

    `certificate` is why the router gets another one, `settings` what else differs in its
    configuration. `new` and `gone` are processes; `added` and `removed` are what the others may
    send and get, under which keys.
    """

    certificate: tuple[str, ...]
    files: tuple[str, ...]
    settings: tuple[str, ...]
    new: tuple[str, ...]
    gone: tuple[str, ...]
    added: Mapping[str, tuple[str, ...]]
    removed: Mapping[str, tuple[str, ...]]
    revokes: bool

    @property
    def differs(self) -> bool:
        """Whether the files do not say, or did not say, what graph and plan say."""
        return bool(self.certificate or self.files)


def zenoh_to_json(report: ZenohReport) -> Mapping[str, object]:
    """Return the JSON document of this part."""
    return {
        "certificate": list(report.certificate),
        "files": list(report.files),
        "settings": list(report.settings),
        "new": list(report.new),
        "gone": list(report.gone),
        "added": {name: list(keys) for name, keys in report.added.items()},
        "removed": {name: list(keys) for name, keys in report.removed.items()},
    }


def zenoh_lines(report: ZenohReport, page: TextPage) -> Iterator[Text]:
    """Yield the lines of this part, none if nothing differs."""
    if report.revokes:
        yield from heading("Zenoh")
        yield from paragraph(_NO_REVOCATION, page, indent=2, style="red")
    if not report.differs:
        return
    yield from heading("Zenoh's router")
    for reason in report.certificate:
        yield line(f"its certificate {reason}", indent=2)
    for name in report.settings:
        yield line(f"{name} differs", indent=2)
    for name in report.gone:
        yield line((f"- {name}", "red"), indent=2)
    for name in report.new:
        yield line((f"+ {name}", "green"), indent=2)
    yield from paragraph(_RESTART, page, indent=2)
    for name in sorted({*report.added, *report.removed}):
        yield from heading(f"Zenoh: {name}")
        yield from _keys(report.removed.get(name, ()), "-", "red")
        yield from _keys(report.added.get(name, ()), "+", "green")


def _keys(keys: tuple[str, ...], sign: str, style: str) -> Iterator[Text]:
    """Yield a line for each key: the messages that may, or may no longer, be sent or got there."""
    messages: dict[tuple[str, str], list[str]] = {}
    for each in keys:
        direction, message, key = each.split(" ", 2)
        messages.setdefault((direction, key), []).append(message)
    for direction, key in list(messages)[:_SHOWN_KEYS]:
        yield line((f"{sign} {key}", style), indent=2)
        yield line(f"{direction} {', '.join(messages[direction, key])}", indent=4)
    if len(messages) > _SHOWN_KEYS:
        rest = f"{len(messages) - _SHOWN_KEYS} more; --format json lists all"
        yield line((f"{sign} {rest}", style), indent=2)
