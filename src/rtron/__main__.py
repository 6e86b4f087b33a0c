"""`python -m rtron` is `rtron`."""

from rtron.cli.main import main

main()
