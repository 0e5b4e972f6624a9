"""How the reader is compiled."""

from __future__ import annotations

from functools import partial

from numba import njit

__all__ = ["njit_kernel", "njit_part"]

#: what Python calls: machine code, kept between runs; no array is made in it
njit_kernel = partial(njit, cache=True, nogil=True, error_model="numpy", _nrt=False)
#: what only kernels call: no way in from Python has to be compiled
njit_part = partial(
    njit, error_model="numpy", _nrt=False, no_cpython_wrapper=True, no_cfunc_wrapper=True
)
