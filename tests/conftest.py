"""Before any test: no compiled kernel that is older than its sources."""

from vmach.kernel_cache import collect_less_often, forget_stale_kernels

forget_stale_kernels()
collect_less_often()
