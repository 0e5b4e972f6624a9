"""How a program is run."""

from __future__ import annotations

from dataclasses import dataclass

__all__ = ["RunOptions"]


@dataclass(frozen=True)
class RunOptions:
    """How a program is run.

    Attributes
    ----------
    block_delete : bool
        Skip blocks that begin with a slash.
    max_blocks : int
        Give up after so many blocks.
    fast : bool
        Use the compiled reader for plain motion, where the dialect has it.
    """

    block_delete: bool
    max_blocks: int
    fast: bool
