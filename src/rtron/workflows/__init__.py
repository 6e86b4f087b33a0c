"""What the command line, the service and the demos call: scan, plan, instrument, verify."""
