"""``vmach batch``: studies of many cases."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Annotated

import typer

from vmach.base.progress import progress_bar
from vmach.base.terminal import console
from vmach.commands.options import AsJson

__all__ = ["batch"]


def batch(
    study: Annotated[Path, typer.Argument(metavar="STUDY", help="study.toml")],
    out: Annotated[
        Path | None, typer.Option("--out", help="folder for the results, the same for all shards")
    ] = None,
    shard: Annotated[
        str, typer.Option(metavar="K/N", help="work on the k-th of n shares of the cases")
    ] = "1/1",
    processes: Annotated[
        int | None, typer.Option(min=1, max=1024, help="on this machine; as many as cores")
    ] = None,
    scheduler: Annotated[
        str | None, typer.Option(metavar="ADDRESS", help="workers of this dask scheduler instead")
    ] = None,
    merge: Annotated[
        Path | None,
        typer.Option(metavar="FILE", help="one table of all results: .csv, .npz, .parquet"),
    ] = None,
    as_json: AsJson = False,
) -> None:
    """Work on the cases of a study that have no result yet."""
    from vmach.files.atomic import check_outputs
    from vmach.files.table_file import check_table_file
    from vmach.study.capability import study_performance
    from vmach.study.printing import print_performance
    from vmach.study.results import ResultFolder
    from vmach.study.run_study import Shard, merge_study, run_study
    from vmach.study.study import read_study

    share = Shard.of_text(shard)
    read = read_study(study)
    folder = out or Path("vmach-results") / read.path.stem
    check_outputs([merge], inputs=[read.path, *read.files()])
    check_table_file(merge)
    with progress_bar() as progress:
        progress("cases", 0, 1)
        found = run_study(
            read, folder, shard=share, processes=processes, scheduler=scheduler, progress=progress
        )
        if merge is not None and not found.failed:
            merge_study(read, folder, merge)
    performance = list(study_performance(read, ResultFolder(folder)))
    figures = {
        "cases": found.cases, "there": found.there, "done": found.done, "failed": found.failed,
        "folder": str(folder), "merged": str(merge) if merge and not found.failed else None,
        "performance": performance,
    }  # fmt: skip
    if as_json:
        print(json.dumps(figures, indent=1))
    else:
        print(f"{folder}: {found.cases} cases, {found.there} were there, {found.done} done"
              + (f"; all of the study in {merge}" if figures["merged"] else ""))  # fmt: skip
        print_performance(console(), performance)
    if found.failed:
        told = f"{found.failed} cases failed; why is in {folder / 'failed'}"
        first = ResultFolder(folder).first_failure()
        print(f"vmach: {told}; the first is {first}", file=sys.stderr)
        raise typer.Exit(1)
