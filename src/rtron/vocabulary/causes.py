"""Why something is unresolved, as the notes of a graph say it and findings ask for it."""

MISSING_PROGRAM = "its program is not in the build files of its package"
SHARED_OUTPUT = "instances of one program publish it, and their other topics differ"
UNKNOWN_NODE = "no node has this name"
UNREAD_PARAMETER = "the node does not declare it"
UNREAD_PUBLISHER = "code that was not understood may publish it"
UNUSED_TOPIC = "no node uses the topic"
NO_EFFECT = "no node that gets it uses the name"
