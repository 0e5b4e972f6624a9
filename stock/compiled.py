"""How the kernels are compiled."""

from __future__ import annotations

from functools import partial

from numba import njit

__all__ = ["njit_inlined", "njit_kernel", "njit_part"]

#: what Python calls: machine code, kept between runs, that leaves the interpreter's lock alone.
#: Kernels make no arrays. So nobody counts references to those that they are handed, which would
#: take most of their time: they look into their records millions of times, between threads
njit_kernel = partial(njit, cache=True, nogil=True, error_model="numpy", _nrt=False)
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
