"""Statistics against numbers worked out by hand."""

import numpy as np
import pytest

from tests.report_case import points, run
from vmach.report import Column, InspectedPoints, RunRecord, column_statistics, worst_places
from vmach.report.figures.statistics import feature_statistics, worst_apart_mm


def column(deviation_um, status=None):
    status = ["cut"] * len(deviation_um) if status is None else status
    return Column("v", "V", 1e-3 * np.array(deviation_um, float), status)


def test_figures_of_four_points():
    figures = column_statistics(column([3.0, -4.0, 0.0, 5.0]), 3.5e-3)
    assert figures.count == 4
    assert figures.mean_mm == pytest.approx(1e-3)
    assert figures.rms_mm == pytest.approx(1e-3 * np.sqrt(12.5))
    assert (figures.min_mm, figures.max_mm) == pytest.approx((-4e-3, 5e-3))
    assert figures.peak_to_valley_mm == pytest.approx(9e-3)
    assert figures.outside_count == 2
    assert figures.outside_share == 0.5


def test_a_point_exactly_on_the_limit_is_within():
    assert column_statistics(column([3.0, -3.0]), 3e-3).outside_count == 0


def test_points_that_are_not_cut_count_only_by_their_status():
    status = ["cut", "uncut", "gouged away", "uncut"]
    figures = column_statistics(column([1.0, 900.0, np.nan, np.nan], status), 2e-3)
    assert figures.status_counts == {"cut": 1, "uncut": 2, "gouged away": 1}
    assert figures.max_mm == pytest.approx(1e-3)


def test_no_cut_point_gives_nan_and_no_warning():
    figures = column_statistics(column([np.nan], ["uncut"]), 1e-3)
    assert figures.count == 0
    assert np.isnan([figures.rms_mm, figures.mean_mm, figures.outside_share]).all()


def on_a_line(x_mm, deviation_um, feature=None):
    """Points along X, all of one feature unless said."""
    count = len(x_mm)
    return InspectedPoints(
        id=[str(i) for i in range(count)],
        feature=["wall"] * count if feature is None else feature,
        point_mm=np.column_stack([x_mm, np.zeros(count), np.zeros(count)]),
        normal=np.tile([0.0, 0.0, 1.0], (count, 1)),
        line=np.ones(count), tool=np.ones(count), move=np.zeros(count), time_s=np.zeros(count),
        columns=(column(deviation_um),),
    )  # fmt: skip


def test_worst_places_are_sorted_by_size_and_ties_keep_their_order():
    case = on_a_line([0.0, 25.0, 50.0, 75.0, 100.0], [2.0, -9.0, 9.0, 1.0, -2.0])
    assert worst_places(case, case.primary, 4).tolist() == [1, 2, 0, 4]


def test_neighbours_of_a_worst_place_are_not_named_beside_it():
    # 100 mm long: two places of one feature are more than 5 mm apart
    x_mm = [0.0, 5.0, 5.1, 50.0, 52.0, 100.0]
    case = on_a_line(x_mm, [9.0, 8.0, 7.0, 6.0, 5.0, 4.0])
    assert worst_apart_mm(case) == pytest.approx(5.0)
    assert worst_places(case, case.primary).tolist() == [0, 2, 3, 5]
    other = on_a_line(x_mm, [9.0, 8.0, 7.0, 6.0, 5.0, 4.0], ["wall", "floor", *4 * ["wall"]])
    assert worst_places(other, other.primary).tolist() == [0, 1, 2, 3, 5]


def test_points_in_one_place_are_one_place():
    case = on_a_line([3.0, 3.0, 3.0], [1.0, 2.0, 3.0])
    assert worst_places(case, case.primary).tolist() == [2]


def test_features_come_in_order_of_appearance_and_add_up():
    case = points()
    by_feature = feature_statistics(case, case["abbe"], 1e-3)
    assert next(iter(by_feature)) == case.feature[0]
    assert sum(s.count for s in by_feature.values()) == case["abbe"].is_cut.sum()


def test_records_refuse_what_would_be_a_silent_error():
    with pytest.raises(ValueError, match="no finite deviation"):
        column([np.nan])
    with pytest.raises(ValueError, match="'lost'; accepted"):
        column([1.0], ["lost"])
    with pytest.raises(ValueError, match="tolerance_mm is nan"):
        run(tolerance_mm=float("nan"))
    case = points(5)
    changed = {name: getattr(case, name) for name in case.__dataclass_fields__}
    with pytest.raises(ValueError, match="normal has shape"):
        InspectedPoints(**(changed | {"normal": np.zeros((4, 3))}))
    with pytest.raises(ValueError, match="different names"):
        InspectedPoints(**(changed | {"columns": (case["none"], case["none"])}))
    with pytest.raises(ValueError, match="read-only"):
        case.point_mm[0] = 0


def test_primary_variant_is_the_last_prediction():
    assert points(5).primary.name == "abbe"
    with pytest.raises(KeyError):
        points(5)["htm"]


def test_nc_text_of_a_line_that_is_not_there_is_empty():
    record = RunRecord("t", "c", "abbe", 1e-3, program_lines=["  G0 X1 \r"])
    assert [record.nc_text(n) for n in (0, 1, 2)] == ["", "G0 X1", ""]
