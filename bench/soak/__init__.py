"""A guarded app that is loaded, killed, frozen and attacked at random for half an hour."""
