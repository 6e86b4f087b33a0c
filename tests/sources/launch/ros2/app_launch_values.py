"""What tests ask of an AppLaunch."""


def names(app):
    """Return the full names of what starts, in order."""
    return [start.full_name for start in app.starts]


def values(start, **how):
    """Return the parameters of a start, without their places."""
    return {name: one.value for name, one in start.parameters(**how).items()}


def whys(app):
    """Return why what is not known is not known."""
    return [note.why for note in app.unresolved]
