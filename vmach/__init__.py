"""vmach: predict the part that a real machine tool makes from an NC program."""

__version__ = "0.1.0"
