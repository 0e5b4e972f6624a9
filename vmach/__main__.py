"""``python -m vmach``."""

from vmach.cli import main

main()
