"""How the C library keeps memory that is free again."""

from __future__ import annotations

import ctypes

__all__ = ["give_back_large_arrays"]

#: M_MMAP_THRESHOLD of <malloc.h>
_MMAP_THRESHOLD = -3
#: larger arrays have pages of their own, and these go back to the system with them
_OWN_PAGES_BYTES = 2**20


def give_back_large_arrays() -> None:
    """Let large arrays go back to the system when they are freed, where the library can do so.

    glibc keeps blocks of up to 32 MB for the next request otherwise: with a program of a million
    moves more than 200 MB that nobody uses.
    """
    try:
        option = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError):  # another C library
        return
    option(_MMAP_THRESHOLD, _OWN_PAGES_BYTES)
