"""What a run leaves to read and look at; docs/report.md describes the files.

The pipeline fills `InspectedPoints` and `RunRecord`, gets a `DisplayMesh` from
`build_display_mesh` and calls the writers inside `vmach.atomic.atomic_folder`.
"""

from vmach.report.coloured_part import part_colours
from vmach.report.deviations_csv import read_deviations_csv, write_deviations_csv
from vmach.report.display_mesh import build_display_mesh, interpolate_to_mesh
from vmach.report.html import write_report_html
from vmach.report.result import (
    STATUSES,
    Colouring,
    Column,
    DisplayMesh,
    InputFile,
    InspectedPoints,
    RunRecord,
)
from vmach.report.statistics import Statistics, column_statistics, worst_places
from vmach.report.summary import SIGN_CONVENTION, summary, write_summary
from vmach.report.table import columns_table
from vmach.report.viewer import open_viewer

__all__ = [
    "SIGN_CONVENTION",
    "STATUSES",
    "Colouring",
    "Column",
    "DisplayMesh",
    "InputFile",
    "InspectedPoints",
    "RunRecord",
    "Statistics",
    "build_display_mesh",
    "column_statistics",
    "columns_table",
    "interpolate_to_mesh",
    "open_viewer",
    "part_colours",
    "read_deviations_csv",
    "summary",
    "worst_places",
    "write_deviations_csv",
    "write_report_html",
    "write_summary",
]
