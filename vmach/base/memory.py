"""How the C library keeps memory that is free again."""

from __future__ import annotations

import ctypes

__all__ = ["give_back_free_memory", "keep_small_arrays"]

#: M_TRIM_THRESHOLD and M_MMAP_THRESHOLD of <malloc.h>
_TRIM_THRESHOLD, _MMAP_THRESHOLD = -1, -3
#: larger arrays have pages of their own, which go back to the system with them: huge ones, which
#: numpy asks for from this size on. Below it each 4 KB is a fault of its own, 0.4 ms a MB
_OWN_PAGES_BYTES = 2**22
#: what is kept for the next request, though free
_KEPT_BYTES = 64 * 2**20


def keep_small_arrays() -> None:
    """Keep small arrays' memory for the next, and give large ones' back, where the library can.

    glibc keeps blocks of up to 32 MB otherwise: with a program of a million moves more than 200 MB
    that nobody uses. Work goes through such programs in blocks below a MB, and a diagnosis weighs
    signatures of 1 to 4 MB; to ask the system for each anew took up to a third of the time.
    """
    try:
        option = ctypes.CDLL(None).mallopt
    except (OSError, AttributeError):  # another C library
        return
    option(_MMAP_THRESHOLD, _OWN_PAGES_BYTES)
    option(_TRIM_THRESHOLD, _KEPT_BYTES)


def give_back_free_memory() -> None:
    """Give the system what the C library keeps, as between two stages that need much each.

    Every thread has a store of its own, which the library does not empty when the thread ends.
    """
    try:
        ctypes.CDLL(None).malloc_trim(0)
    except (OSError, AttributeError):  # another C library
        return
