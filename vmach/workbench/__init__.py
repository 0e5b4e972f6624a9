"""The workbench: see, ask, add and watch the error fall, in a browser on this machine.

`launch` starts it. The server (`server`, `routes`) holds what is open (`session`) and no arrays: a
process of its own (`model`) holds the part, and long work is a command of vmach (`command_runs`).
"""
