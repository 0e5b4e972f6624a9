"""How the kernels are compiled."""

from __future__ import annotations

from functools import partial

from numba import njit, types
from numba.extending import intrinsic

__all__ = ["njit_inlined", "njit_kernel", "unowned"]

#: machine code, kept between runs, that leaves the interpreter's lock alone
njit_kernel = partial(njit, cache=True, nogil=True, error_model="numpy")
#: the same, put into its caller: the records that kernels share are costly to hand over
njit_inlined = partial(njit_kernel, forceinline=True)


@intrinsic
def unowned(context, record):
    """The same record of arrays, without counting references to them.

    Kernels look into their records millions of times; counting each look, safely between
    threads, would take most of their time. The caller keeps the record alive meanwhile.
    """

    def without_owner(target, builder, kind, value):
        if isinstance(kind, types.Array):
            array = target.make_array(kind)(target, builder, value)
            array.meminfo = target.get_constant_null(types.MemInfoPointer(types.voidptr))
            return array._getvalue()
        for place, part in enumerate(kind.types):
            old = builder.extract_value(value, place)
            new = without_owner(target, builder, part, old)
            value = builder.insert_value(value, new, place)
        return value

    def generate(target, builder, signature, arguments):
        return without_owner(target, builder, signature.args[0], arguments[0])

    return record(record), generate
