"""What a run leaves to read and look at; docs/report.md describes the files.

The pipeline fills `InspectedPoints` and `RunRecord`, gets a `DisplayMesh` from
`build_display_mesh` and calls the writers inside `vmach.files.atomic.atomic_folder`.
"""

from vmach.report.exchange.formats import ENDINGS, check_ending, write_features_file
from vmach.report.figures.arms import arms_text
from vmach.report.figures.circular_tests import circular_table
from vmach.report.figures.deviations_csv import read_deviations_csv, write_deviations_csv
from vmach.report.figures.differences import differences_text
from vmach.report.figures.features import features_table
from vmach.report.figures.statistics import Statistics, column_statistics, worst_places
from vmach.report.figures.summary import SIGN_CONVENTION, summary, write_summary
from vmach.report.figures.table import columns_table
from vmach.report.page.page import ReportView, write_report_html
from vmach.report.pictures.coloured_part import part_colours
from vmach.report.pictures.display_mesh import build_display_mesh, interpolate_to_mesh
from vmach.report.pictures.viewer import open_viewer
from vmach.report.result import (
    STATUSES,
    Colouring,
    Column,
    DisplayMesh,
    InputFile,
    InspectedPoints,
    RunRecord,
    SolidComparison,
    SolidDifference,
)

__all__ = [
    "ENDINGS",
    "SIGN_CONVENTION",
    "STATUSES",
    "Colouring",
    "Column",
    "DisplayMesh",
    "InputFile",
    "InspectedPoints",
    "ReportView",
    "RunRecord",
    "SolidComparison",
    "SolidDifference",
    "Statistics",
    "arms_text",
    "build_display_mesh",
    "check_ending",
    "circular_table",
    "column_statistics",
    "columns_table",
    "differences_text",
    "features_table",
    "interpolate_to_mesh",
    "open_viewer",
    "part_colours",
    "read_deviations_csv",
    "summary",
    "worst_places",
    "write_deviations_csv",
    "write_features_file",
    "write_report_html",
    "write_summary",
]
