from launch.core import normalize, perform


def space_of(context, namespace):
    """A namespace as it counts below the pushed one; None where neither is given."""
    base = context.launch_configurations.get("ros_namespace")
    own = None if namespace is None else perform(context, normalize(namespace))
    if base is None and own is None:
        return None
    if own is None:
        joined = base
    elif not base or own.startswith("/"):
        joined = own
    else:
        joined = f"{'' if base == '/' else base}/{own}"
    joined = joined if joined == "/" else joined.rstrip("/")
    return joined if joined.startswith("/") else f"/{joined}"
