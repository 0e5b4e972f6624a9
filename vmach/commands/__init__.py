"""The commands: one file for each, or for a few that belong together.

A command reads its options, has the work done, and says or writes what came of it. What does the
work is imported inside the command, so that ``vmach --help`` and small commands need not wait for
compilers, solids and pictures that they do not use.
"""
