"""Work on the cases of a study that have no result yet, and put the results together."""

from __future__ import annotations

import re
from dataclasses import dataclass
from pathlib import Path

from stock.threads import available_cores
from vmach.base.stage_clock import Progress, silent
from vmach.errors import InputError
from vmach.files.table_file import check_table_file, write_table
from vmach.study.results import ResultFolder, merged_columns
from vmach.study.study import Study
from vmach.study.workers import work_here, work_in_processes

__all__ = ["Shard", "Worked", "merge_study", "run_study"]


@dataclass(frozen=True)
class Shard:
    """One of several shares of a study, 1 to `of`."""

    number: int = 1
    of: int = 1

    @classmethod
    def of_text(cls, text: str) -> Shard:
        """From ``3/64``.

        Raises
        ------
        InputError
        """
        found = re.fullmatch(r"(\d{1,9})/(\d{1,9})", text)
        shard = cls(*map(int, found.groups())) if found else cls(0, 0)
        if not 1 <= shard.number <= shard.of:
            raise InputError(
                f"--shard {text}", accepted="NUMBER/COUNT with 1 <= NUMBER <= COUNT, such as 3/64"
            )
        return shard


@dataclass(frozen=True)
class Worked:
    """What became of the cases of one run.

    Attributes
    ----------
    cases : int
        Of the study, or of its shard.
    there : int
        Had results before.
    done, failed : int
        Of this run.
    """

    cases: int
    there: int
    done: int
    failed: int


def run_study(
    study: Study,
    out: str | Path,
    *,
    shard: Shard | None = None,
    processes: int | None = None,
    scheduler: str | None = None,
    progress: Progress = silent,
) -> Worked:
    """Work on every case that has no result in the folder.

    Parameters
    ----------
    study : Study
    out : path
        Folder of the results; the same for all shards.
    shard : Shard, optional
        All cases where left out.
    processes : int, optional
        As many as there are cores where left out; 1 is this process alone.
    scheduler : str, optional
        Address of a dask scheduler, whose workers do it instead.
    progress : Progress

    Raises
    ------
    InputError
        The folder holds something else; no dask scheduler answers.

    Examples
    --------
    >>> from pathlib import Path
    >>> import vmach
    >>> law = "def twice(case, random): return {'y': 2 * case.values['x']}"
    >>> _ = Path("twice.py").write_text(law)
    >>> text = 'schema = 1\\nseed = 1\\nfunction = "twice:twice"\\n[cases]\\nx = [1, 2, 3]'
    >>> _ = Path("study.toml").write_text(text)
    >>> study = vmach.read_study("study.toml")
    >>> vmach.run_study(study, "out", processes=1).done
    3
    """
    folder, shard = ResultFolder(Path(out)), shard or Shard()
    folder.open_for(study)
    mine = study.shard(shard.number, shard.of)
    known = folder.done()
    cases = [case for case in mine if case.key not in known]
    count = {True: 0, False: 0}

    def tell(is_result: bool) -> None:
        count[is_result] += 1
        progress("cases", sum(count.values()), len(cases))

    processes = min(processes or available_cores(), max(len(cases), 1))
    if scheduler:
        from vmach.study.dask_workers import work_on_cluster  # late: an extra

        work_on_cluster(study.task, cases, folder, tell, address=scheduler)
    elif processes == 1:
        work_here(study.task, cases, folder, tell)
    else:
        work_in_processes(study.task, cases, folder, tell, processes=processes)
    return Worked(len(mine), len(mine) - len(cases), count[True], count[False])


def merge_study(study: Study, out: str | Path, table: Path) -> int:
    """Write one table of all results, a row a case in the order of the study; gives the rows.

    Raises
    ------
    InputError
        A case has no result; the file cannot be written.

    Examples
    --------
    >>> from pathlib import Path
    >>> import vmach
    >>> law = "def twice(case, random): return {'y': 2 * case.values['x']}"
    >>> _ = Path("twice.py").write_text(law)
    >>> text = 'schema = 1\\nseed = 1\\nfunction = "twice:twice"\\n[cases]\\nx = [1, 2, 3]'
    >>> _ = Path("study.toml").write_text(text)
    >>> study = vmach.read_study("study.toml")
    >>> _ = vmach.run_study(study, "out", processes=1)
    >>> vmach.merge_study(study, "out", Path("all.csv"))
    3
    """
    check_table_file(table)
    folder = ResultFolder(Path(out))
    folder.open_for(study)
    write_table(table, merged_columns(study.cases, folder))
    return len(study.cases)
