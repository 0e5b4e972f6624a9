"""Workers of a dask cluster that is there already (``pip install 'vmach[dask]'``)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from vmach.errors import InputError
from vmach.study.case import Case
from vmach.study.results import ResultFolder
from vmach.study.task import Task
from vmach.study.workers import worked

__all__ = ["work_on_cluster"]

#: seconds that a scheduler has to answer
_PATIENCE_S = 10
#: workers that may die under a case before it has failed
_TRIES = 3
#: cases that the scheduler knows at a time
_AT_ONCE = 2000


def work_on_cluster(
    task: Task,
    cases: Sequence[Case],
    folder: ResultFolder,
    tell: Callable[[bool], None],
    *,
    address: str,
) -> None:
    """Work on the cases on the workers of a dask scheduler.

    Results come back to this process, which writes them: workers need to see the study's folder,
    but not that of the results.

    Parameters
    ----------
    task : Task
    cases : sequence of Case
    folder : ResultFolder
    tell : callable
        Told of every case whether it has a result.
    address : str
        Of the scheduler: ``tcp://host:8786``.

    Raises
    ------
    InputError
        dask is not installed, or nobody answers.
    """
    with _client(address) as client, client.as_current():
        for start in range(0, len(cases), _AT_ONCE):
            _work_on_some(client, task, cases[start : start + _AT_ONCE], folder, tell)


def _client(address: str) -> Any:
    try:
        from distributed import Client
    except ImportError:
        raise InputError(
            f"--scheduler {address}: dask is not installed",
            accepted="the installation 'vmach[dask]'",
        ) from None
    try:
        return Client(address, timeout=_PATIENCE_S, set_as_default=False)
    except (OSError, ValueError) as error:
        raise InputError(
            f"--scheduler {address}: {error}",
            accepted="the address that 'dask scheduler' prints, such as tcp://host:8786",
        ) from None


def _work_on_some(
    client: Any,
    task: Task,
    cases: Sequence[Case],
    folder: ResultFolder,
    tell: Callable[[bool], None],
) -> None:
    from distributed import as_completed

    futures = client.map(
        worked, [task] * len(cases), cases, pure=False, retries=_TRIES, batch_size=100
    )
    case_of = {future.key: case for future, case in zip(futures, cases, strict=True)}
    for future in as_completed(futures):
        case = case_of[future.key]
        try:  # a result that died with its worker is waited for once more
            text, is_result = future.result()
        except Exception as error:
            text, is_result = f"no worker finished it: {error!r}", False
        (folder.keep if is_result else folder.keep_failure)(case, text)
        tell(is_result)
        future.release()
