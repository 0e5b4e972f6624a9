"""The diagnosis runs BLAS with one thread: small matrices lose more by threads than they gain."""

import os
from pathlib import Path

import pytest
import scipy.linalg.lapack  # noqa: F401  (loads its own BLAS beside numpy's)
from threadpoolctl import threadpool_info, threadpool_limits

_MAPS = Path("/proc/self/maps")


@pytest.mark.skipif(not _MAPS.exists(), reason="the kernel does not list what is loaded")
def test_every_blas_that_is_loaded_obeys_the_limit():
    """Threadpoolctl before 3.5 passes scipy's own OpenBLAS over, which then spins."""
    lines = _MAPS.read_text().splitlines()
    loaded = {line.split()[-1] for line in lines if "openblas" in line and ".so" in line}
    if not loaded:
        pytest.skip("no OpenBLAS is loaded")
    with threadpool_limits(limits=1, user_api="blas"):
        threads = {
            os.path.realpath(one["filepath"]): one["num_threads"] for one in threadpool_info()
        }
    assert {os.path.realpath(path): threads.get(os.path.realpath(path)) for path in loaded} == {
        os.path.realpath(path): 1 for path in loaded
    }
