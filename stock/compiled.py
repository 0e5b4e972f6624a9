"""How the kernels are compiled."""

from __future__ import annotations

from functools import partial

import numpy as np
from numba import njit

__all__ = ["njit_inlined", "njit_kernel", "njit_maker", "njit_part", "read_only"]

#: what Python calls: machine code, kept between runs, that leaves the interpreter's lock alone.
#: Kernels make no arrays. So nobody counts references to those that they are handed, which would
#: take most of their time: they look into their records millions of times, between threads
njit_kernel = partial(njit, cache=True, nogil=True, error_model="numpy", _nrt=False)
#: what Python calls and what makes arrays: those it returns, or room to work in
njit_maker = partial(njit, cache=True, nogil=True, error_model="numpy")
#: what only kernels call: without a way in from Python, which takes as long to compile as the rest
njit_part = partial(
    njit,
    nogil=True,
    error_model="numpy",
    _nrt=False,
    no_cpython_wrapper=True,
    no_cfunc_wrapper=True,
)
#: the same, put into its caller: the records that kernels share are costly to hand over
njit_inlined = partial(njit_part, forceinline=True)


def read_only(array: np.ndarray) -> np.ndarray:
    """View of an array of any shape, (...,), for kernels that only read it.

    A kernel is compiled once for arrays that may be written and once more for those that may
    not, whatever it does with them. Callers' arrays come in both kinds.
    """
    view = array.view()
    view.setflags(write=False)
    return view
