"""A plan that comes as text, from the network: what `rtron check` refuses is refused."""

from rtron.vocabulary import Plan


def read_checked_plan(text: str) -> Plan:
    """Return the plan of a document; PlanError or InputError tells all that is wrong with it.

    What reads plans is loaded only here: a guard that gets no plan never needs it.
    """
    from rtron.planning.plan_file.loader import parse_plan  # noqa: PLC0415 - see above
    from rtron.workflows.check_plan import require_fit  # noqa: PLC0415 - see above

    plan = parse_plan(text)
    require_fit(plan, None)
    return plan
