"""What ``import vmach`` offers to Python programs; every name is reached as ``vmach.NAME``.

Numbers that go in and come out are in the units of their names: mm for places and lengths, um for
deviations and errors, urad for angles, as in vmach's files.
"""
