"""The interaction graph of an app that does not run: from its launch files and its source."""
