"""Keys as rmw_zenoh makes them, written down from its source a second time, part by part."""

TYPE = "geometry_msgs::msg::dds_::Twist_"
HASH = "RIHS01_9c45bf16fe0983d80e3cfe750d6835843d265a9a6c46bd2e609fcddde6fb8d2a"
CACHE = "@adv/pub/d0bc47e6b10a3b6eb1bd43fa5c3dd1a1/11/_"
"""What a publisher that stores messages adds to its key (zenoh-ext, AdvancedPublisher)."""
_QOS = "::,10:,:,:,,"


def data_key(domain, name, type=TYPE, hash=HASH):
    """TopicInfo: domain, the name without slashes at its ends, type, hash."""
    return "/".join((str(domain), name.strip("/"), type, hash))


def node_token(domain, node, enclave="/"):
    """Entity, of a node."""
    return _token(domain, "NN", node, enclave)


def endpoint_token(domain, kind, node, name, enclave="/"):
    """Entity, of what a node has."""
    parts = (_token(domain, kind, node, enclave), _mangled(name), _mangled(TYPE), HASH, _QOS)
    return "/".join(parts)


def _token(domain, kind, node, enclave):
    namespace, _, name = node.rpartition("/")
    session = "e1f2a3"
    ids = (str(domain), session, "0", "0")
    names = (_mangled(enclave), _mangled(namespace or "/"), name)
    return "/".join(("@ros2_lv", *ids, kind, *names))


def _mangled(name):
    return name.replace("/", "%")
