"""Before any test: no compiled kernel that is older than its sources."""

from vmach.kernel_cache import compile_without_collection, forget_stale_kernels

forget_stale_kernels()
compile_without_collection()
