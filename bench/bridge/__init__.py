"""The bridge: what it adds to a message."""
