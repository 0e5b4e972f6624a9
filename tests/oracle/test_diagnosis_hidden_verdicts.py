"""The diagnosis on machines with a hidden effect that no code of the program made.

The generator has its own machine, path, contact and formulas (`tests/hidden_effects`); the
program sees files only. `tests/benchmarks/bench_hidden_effects.py` does the same by the hundred.
"""

import json
from itertools import combinations

import numpy as np
import pytest

from tests.hidden_effects import program_runs
from tests.hidden_effects.experiment import KINDS, make_experiment
from tests.hidden_effects.instruments import INSTRUMENTS
from tests.hidden_effects.part import PartDesign
from tests.hidden_effects.state import Hidden
from tests.hidden_effects.verdict import judge
from vmach.diagnosis.inference.moves import search, search_beyond
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.inference.rules import CLEARLY
from vmach.diagnosis.residuals.job_survey import survey_job

NOISE_UM = 0.8
#: hidden effects, seed, instruments beside the CMM, outcomes that are right
CASES = {
    "healthy": ([], 31, (), {"right"}),
    "warm workpiece": (["workpiece_temperature"], 31, (), {"class"}),
    "wave of the screw": (["cyclic_pitch"], 31, (), {"right"}),  # once ended in a traceback
    "second clamping": (["fixture"], 52, (), {"right"}),
    "two at once": (["servo_mismatch", "backlash"], 31, (), {"right"}),
    "corners cut late": (["corner_rounding"], 701, (), {"right"}),
    "screw without a scale": (["axis_expansion"], 701, (), {"right"}),
    "foreign": (["bump_field"], 31, (), {"right"}),
    "healthy, every instrument": ([], 32, tuple(INSTRUMENTS), {"right"}),
    "ballbar and laser": (["servo_mismatch"], 32, ("ballbar_xy", "laser_X"), {"right"}),
}


@pytest.mark.parametrize("name", CASES)
def test_verdict_parameters_and_held_out_error(tmp_path, name):
    effects, seed, instruments, outcomes = CASES[name]
    made = make_experiment(tmp_path, effects=effects, seed=seed, instruments=instruments)
    report, _ = program_runs.diagnose(tmp_path)
    found = judge(report, json.loads((tmp_path / "truth.json").read_text()))
    assert found.outcome in outcomes, found.said
    assert len(found.parameters) == sum(len(h.comparable) for h in made.hidden)
    for parameter, value, low, high, true in found.parameters:
        wide = 3.0 / 1.96  # an interval of 99.7 %: one of twenty may miss that of 95 %
        assert value + wide * (low - value) < true < value + wide * (high - value), parameter
    if report["verdict"] not in ("named", "class"):
        return
    before, _ = program_runs.held_out(tmp_path / "job.toml", made.check)
    after, covered = program_runs.held_out(program_runs.add(tmp_path, report), made.check)
    assert after < 1.2 * NOISE_UM < before
    assert covered > 0.93


@pytest.mark.parametrize(
    ("effects", "seed", "instruments"),
    [
        (["tool_deflection"], 9002, ()),  # one bore that only itself can foretell
        (["head_tilt", "ambient_drift"], 42, ("drift",)),  # all along X in one piece
        (["springback"], 2510000, ()),  # a bend that five effects of the machine imitate together
        (["springback"], 2510007, ()),  # a small bend that two angular tables imitate
        (["loose_collet"], 33013, ()),  # a wave's numbers fit three heights as well
    ],
)
def test_what_held_out_features_and_single_features_can_say(tmp_path, effects, seed, instruments):
    make_experiment(tmp_path, effects=effects, seed=seed, instruments=instruments)
    report, _ = program_runs.diagnose(tmp_path)
    found = judge(report, json.loads((tmp_path / "truth.json").read_text()))
    assert found.outcome == "right", found.said


@pytest.mark.parametrize(
    ("seed", "name"),
    [
        (33000, "tool_length"),  # before its first floor
        (33010, "tool_slip"),  # in the middle of a floor
    ],
)
def test_where_a_tool_slipped_decides_what_is_said(tmp_path, seed, name):
    make_experiment(tmp_path, effects=["loose_collet"], seed=seed)
    report, _ = program_runs.diagnose(tmp_path)
    assert report["verdict"] in ("named", "class")
    assert report["effects"][0]["effect"] == name
    truth = json.loads((tmp_path / "truth.json").read_text())
    assert name in {effect["name"] for effect in truth["effects"]}


def test_a_form_for_what_nobody_foresaw_halves_the_error_of_another_part(tmp_path):
    made = make_experiment(tmp_path, effects=["springback"], seed=7700015)
    report, _ = program_runs.diagnose(tmp_path)
    assert report["proposals"][0]["formula"] == "as a plate bends and twists"
    assert program_runs.left_by_proposal(tmp_path, made.check_share_um[0], made.check) < 0.5


@pytest.mark.parametrize(
    ("kind", "seed", "noise", "formula"),
    [
        # products with a place come near it
        ("swinging_head", 37006001, "white", "acceleration of X on arcs in m/s², along Y"),
        # 6.49 Hz, fading within 0.45 s
        (
            "ringing",
            37056007,
            "device_scale",
            "ringing of 6.48 Hz after X turned, fading within 0.4 s, along X",
        ),
        # 24.7 mm, between two that are on the list; lost motion and a loop stood for it
        ("creeping_axis", 69500002, "white", "what fades 25 mm after X turned, along X"),
        # at the ends of grooves another moment makes the floor than without the nod
        ("nodding_column", 37036002, "heavy_tails", "speed of Y in m/min, as a turn about X"),
    ],
)
def test_the_first_form_is_the_law_and_foretells_another_part(tmp_path, kind, seed, noise, formula):
    design = PartDesign(corners=seed % 3 == 0, two_set_ups=seed % 5 == 0)
    made = make_experiment(tmp_path, effects=[kind], seed=seed, design=design, noise=noise)
    report, _ = program_runs.diagnose(tmp_path)
    assert report["proposals"][0]["formula"] == formula
    assert program_runs.left_by_proposal(tmp_path, made.check_share_um[0], made.check) < 0.25


@pytest.mark.parametrize(
    ("hidden", "seed", "noise", "labels"),
    [
        # of endless size it would leave so much open that it could be of any size
        ("press_next_door", 3445005, "device_scale", ("ambient_drift XYZ", "datum_shift")),
        # what roughing left of every single slot could do all of it
        ("swelling_walls", 3995027, "heavy_tails", ("tool_deflection",)),
    ],
)
def test_what_the_laws_leave_open_never_makes_the_fit_worse(tmp_path, hidden, seed, noise, labels):
    design = PartDesign(corners=seed % 3 == 0, two_set_ups=seed % 5 == 0)
    make_experiment(tmp_path, effects=[hidden], seed=seed, design=design, noise=noise)
    survey = survey_job(tmp_path / "job.toml")
    weighing = prepare_weighing(survey)
    found = weighing.nothing()
    for label in labels:
        found = weighing.extend(found, weighing.index_of(label))
    fit = weighing.careful(found)
    left = survey.residual_mm - sum(fit.explained_mm(k) for k in range(len(labels)))
    both_mm = np.stack([survey.residual_mm, left], axis=1)
    before, after = np.sqrt(np.mean((both_mm - survey.aligned(both_mm)) ** 2, axis=0))
    assert after < 0.7 * before


@pytest.mark.parametrize(
    ("effects", "seed", "noise", "design"),
    [
        # two radii, a shift and a length stand for a probe's radius, a chip and growth
        (
            ["probe_radius", "tool_chip", "head_tilt", "spindle_growth"],
            3664011,
            "device_scale",
            PartDesign(corners=True),
        ),
        # wandering of 10 u stands for a drift, a squareness and a length together
        (
            ["quadrant_glitch", "ambient_drift", "tool_length", "squareness", "backlash"],
            3664004,
            "u_half",
            PartDesign(),
        ),
        # where a play lifts the tool another pass makes the floor; else two drifts stand for it
        (
            ["lateral_play", "servo_mismatch", "tool_deflection"],
            3993001,
            "common",
            PartDesign(corners=True),
        ),
        # with a squareness alone the chip would lengthen the tool: its length has to come along
        (["squareness", "tool_length", "tool_chip"], 4223019, "common", PartDesign(corners=True)),
        # a smooth field stands for three; others come nearer at first, and then give way
        (
            [
                "head_tilt",
                "workpiece_temperature",
                "squareness",
                "table_load_sag",
                "missing_table",
            ],
            7325002,
            "correlated",
            PartDesign(),
        ),
        # the same for two; what neighbours had in common counted as tails and hid all four
        (
            ["workpiece_warming", "drifted_table", "tool_deflection", "tool_length"],
            7324003,
            "correlated",
            PartDesign(),
        ),
        # a reflector a metre off stands for the table, until what nature has is looked for
        (
            ["probe_radius", "hysteresis", "datum_shift", "servo_lag", "drifted_table"],
            11055004,
            "device_scale",
            PartDesign(),
        ),
        # a chip that makes the tool longer stands for another tool's length
        (
            ["fixture", "tool_chip", "leaning_column", "tool_length", "hysteresis"],
            11035002,
            "heavy_tails",
            PartDesign(corners=True),
        ),
        # a tool too small and a chip of it say nothing alone: before the chip all walls are off
        (
            ["tool_radius", "thermal_bow", "workpiece_warming", "tool_chip", "backlash"],
            17005007,
            "white",
            PartDesign(),
        ),
        # a slip stands where the chip was, and the chip where nothing was
        (
            ["corner_rounding", "workpiece_temperature", "tool_chip"],
            17023003,
            "correlated",
            PartDesign(),
        ),
        # a loop that would build up over metres stands for lost motion and a shift
        (
            ["backlash", "drifted_table", "hysteresis", "datum_shift"],
            43004004,
            "white",
            PartDesign(corners=True),
        ),
        # a chip stands for a slip and a chip at another moment
        (["spindle_growth", "tool_slip", "tool_chip"], 49023007, "correlated", PartDesign()),
    ],
)
def test_sets_that_no_single_exchange_leads_to_are_found(tmp_path, effects, seed, noise, design):
    make_experiment(tmp_path, effects=effects, seed=seed, design=design, noise=noise)
    report, _ = program_runs.diagnose(tmp_path)
    found = judge(report, json.loads((tmp_path / "truth.json").read_text()))
    # what these floors cannot tell apart makes one class of each larger than is useful, and chance
    # may speak for one more: all that are there have to be told
    assert found.outcome in ("right", "class", "vague", "extra"), found.said


def test_all_pairs_that_could_stand_in_the_place_of_one_effect_are_tried(tmp_path):
    """A tool that is too long, and slips, makes all but the heights of a slow drift along Z."""
    hidden = ["tool_length", "quadrant_glitch", "missing_table", "tool_slip"]
    make_experiment(tmp_path, effects=hidden, seed=69054001, noise="device_scale")
    whole = prepare_weighing(survey_job(tmp_path / "job.toml"))
    of_height = {"ambient_drift Z", "scale Z", "spindle_growth Z", "axis_expansion Z"}
    of_tools = {f"{name} T{k}" for name in ("tool_length", "tool_slip") for k in (1, 2)}
    labels = {"component ECX", "quadrant_glitch Y"} | of_height | of_tools
    weighing = whole.with_candidates([c for c in whole.candidates if c.label in labels])
    found = search_beyond(weighing, search(weighing, weighing.nothing()))
    assert {"component ECX", "quadrant_glitch Y", "tool_slip T1"} < found.labels
    for k in range(len(found.terms)):
        others = weighing.without(found, [k], resize=False)
        for pair in combinations(sorted(labels - found.labels), 2):
            both = others
            for label in pair:
                both = weighing.extend(both, weighing.index_of(label))
            alone = [weighing.extend(others, weighing.index_of(label)) for label in pair]
            is_idle = both.score < max(one.score for one in alone) + 0.5
            if both.score > found.score - CLEARLY and not is_idle:
                assert both.score < found.score + 0.5 and both.labels in weighing.tried


@pytest.mark.parametrize(
    ("kind", "seed", "noise", "design", "formula"),
    [
        # a servo mismatch with a straightness
        (
            "nodding_column",
            3775042,
            "white",
            PartDesign(corners=True),
            "speed of Y in m/min, as a turn about X",
        ),
        # four effects; large offsets of the walls hide what the form does alone
        (
            "nodding_column",
            5136007,
            "common",
            PartDesign(),
            "speed of Y in m/min, as a turn about X",
        ),
        # one effect: a drift with the room
        (
            "pulsing_oil",
            5156001,
            "heavy_tails",
            PartDesign(corners=True),
            "a wave of 180.7 s in time, along X, Y and Z",
        ),
    ],
)
def test_effects_that_imitate_another_cause_give_way_to_its_form(
    tmp_path, kind, seed, noise, design, formula
):
    make_experiment(tmp_path, effects=[kind], seed=seed, design=design, noise=noise)
    report, _ = program_runs.diagnose(tmp_path)
    assert report["verdict"] == "unknown"
    assert formula in [proposal["formula"] for proposal in report["proposals"]]


def test_an_effect_is_shown_beside_a_cause_that_others_imitate(tmp_path):
    """A bending tool imitates walls that swell; their form takes its place, not the squareness'."""
    hidden = ["squareness", "swelling_walls"]
    make_experiment(tmp_path, effects=hidden, seed=7307007, design=PartDesign(corners=True))
    report, _ = program_runs.diagnose(tmp_path)
    assert report["verdict"] == "partly"
    (shown,) = report["effects"]
    assert (shown["effect"], shown["target"], shown["class"]) == (
        "squareness",
        "C0Y",
        ["squareness"],
    )
    assert any("depth below the top" in state for state in report["proposals"][0]["states"])


@pytest.mark.parametrize(
    ("effects", "seed", "noise", "design"),
    [
        # beside a discrepancy alone 175 urad of 25, with an interval from 86 to 258
        (["squareness", "loose_gib"], 981205, "common", PartDesign(two_set_ups=True)),
        # 11.5 um of 9.1
        (["tool_radius", "loose_gib"], 981176, "correlated", PartDesign()),
        # -0.13 ms of 0.40: wandering in time hid the mismatch, until a form took its place
        (
            ["servo_mismatch", "swinging_head"],
            67057002,
            "device_scale",
            PartDesign(corners=True),
        ),
    ],
)
def test_a_parameter_is_told_beside_the_form_of_what_nobody_foresaw(
    tmp_path, effects, seed, noise, design
):
    make_experiment(tmp_path, effects=effects, seed=seed, design=design, noise=noise)
    report, _ = program_runs.diagnose(tmp_path)
    found = judge(report, json.loads((tmp_path / "truth.json").read_text()))
    assert found.named == found.true == 1, found.said
    ((_, value, low, high, true),) = found.parameters
    # beside a discrepancy alone the intervals are 6.8 and 0.9 times as wide as the truth is large,
    # and the values 595 % and 26 % off
    assert low < true < high and high - low < 0.5 * abs(true)
    assert value == pytest.approx(true, rel=0.1)
    # what the effect leaves is what is said to remain, and noise
    rms = report["rms_um"]
    left = np.hypot(report["remains_um"], rms["expected_noise"])
    assert rms["after"] == pytest.approx(left, rel=0.1) and rms["after"] < rms["before"]


@pytest.mark.parametrize(
    ("effects", "seed", "noise", "shown"),
    [
        # of the play of a gib, and of lost motion that comes and goes, the mean is an effect
        (["loose_gib"], 7306002, "white", []),
        (["tool_radius", "loose_gib"], 7610007, "common", ["tool_radius"]),
        # the nut of the other axis says nothing of this one
        (["backlash", "loosening_nut"], 7307006, "white", ["backlash"]),
        # beside a column that nods a bent table stood for what the squareness left
        (["squareness", "nodding_column"], 981217, "common", ["squareness"]),
        # 3.7 um where it acts, 1.6 um of another cause there, and most of all that is to be seen
        (["backlash", "ringing"], 7337001, "heavy_tails", ["backlash"]),
        # a chipped tool stood for both; a form said what the radius does
        (["tool_radius", "lobed_probe"], 9007001, "white", ["tool_radius"]),
    ],
)
def test_effects_are_judged_beside_the_form_of_what_nobody_foresaw(
    tmp_path, effects, seed, noise, shown
):
    design = PartDesign(corners=seed % 3 == 0, two_set_ups=seed % 5 == 0)
    make_experiment(tmp_path, effects=effects, seed=seed, design=design, noise=noise)
    report, _ = program_runs.diagnose(tmp_path)
    named = [entry["effect"] for entry in report["effects"] if entry["effect"] != "unknown"]
    assert named == shown and report["verdict"] == ("partly" if shown else "unknown")


@pytest.mark.parametrize(
    ("effects", "seed", "noise", "design"),
    [
        (["squareness", "nodding_column"], 981217, "common", PartDesign()),
        (["tool_radius", "loose_gib"], 981176, "correlated", PartDesign()),
    ],
)
def test_an_effect_and_a_form_together_foretell_another_part(
    tmp_path, effects, seed, noise, design
):
    """The effect is added first; what it made up for would be missing from the form."""
    made = make_experiment(tmp_path, effects=effects, seed=seed, design=design, noise=noise)
    report, _ = program_runs.diagnose(tmp_path)
    job = program_runs.add(tmp_path, report)
    told_um = program_runs.predicted_um(
        job.with_name("job.toml"), tmp_path / "check_measured.csv", program=tmp_path / "check.nc"
    )
    left_um, beside_form_um = program_runs.misfits_um(job, made.check_deviation_um, made.check)
    # free of noise, whose size is 0.8 um in a point; without the form about 4.3 and 1.5 um are left
    assert beside_form_um < 0.5 < 3.0 < left_um
    assert left_um < program_runs.aligned_rms_um(told_um, made.check)


def test_a_form_takes_the_place_of_two_effects_and_leaves_a_third(tmp_path):
    """A head that tilts and a worn guide together imitate the beat of a chiller."""
    make_experiment(tmp_path, effects=["fixture", "chiller"], seed=7610006)
    report, _ = program_runs.diagnose(tmp_path)
    assert report["verdict"] == "partly"
    assert [e["effect"] for e in report["effects"]] == ["fixture"]
    assert {e["effect"] for e in report["weak_effects"]} == {"head_tilt", "component"}


def test_two_tools_that_wear_alike_are_no_other_cause(tmp_path, monkeypatch):
    """The cutting length alone says as much with one amount; both wears do nothing else."""

    def both_wear(rng, machine):
        def move(state):
            return 6e-3 * (state.cut_mm / 2200.0)[:, None] * state.normal * [1, 1, 0]

        return Hidden("tool_wear", ("tool_wear",), {}, move, on_part_only=True)

    monkeypatch.setitem(KINDS, "both_wear", both_wear)
    make_experiment(tmp_path, effects=["both_wear", "squareness"], seed=3, noise="heavy_tails")
    report, _ = program_runs.diagnose(tmp_path)
    shown = {(e["effect"], e["target"]) for e in report["effects"]}
    assert shown == {("tool_wear", "T1"), ("tool_wear", "T2"), ("squareness", "C0Y")}


def test_a_wave_in_time_is_found_though_offsets_of_features_could_hold_it(tmp_path):
    """Each feature takes less time than a turn: its offset is the wave's mean there."""
    make_experiment(tmp_path, effects=["pulsing_oil"], seed=5126005)
    report, _ = program_runs.diagnose(tmp_path)
    true_s = json.loads((tmp_path / "truth.json").read_text())["effects"][0]["parameters"]
    said = report["proposals"][0]["formula"].split()
    assert " ".join(said[5:]) == "in time, along X, Y and Z"
    assert float(said[3]) == pytest.approx(true_s["period_s"], rel=0.01)


def test_a_large_drift_in_time_is_an_effect_and_hides_no_others(tmp_path):
    """A wandering of 9 u, of which no law knows, explained a drift and a shift about as well."""
    hidden = ["lateral_play", "ambient_drift", "datum_shift"]
    make_experiment(tmp_path, effects=hidden, seed=5653006)
    report, _ = program_runs.diagnose(tmp_path)
    assert {(e["effect"], e["target"]) for e in report["effects"]} == {
        ("lateral_play", "YZ"),
        ("ambient_drift", "XYZ"),
        ("datum_shift", None),
    }


def test_the_noise_is_that_which_all_effects_leave(tmp_path):
    """What a shift does looked like tails before it was found; as tails it hid two effects."""
    hidden = ["datum_shift", "workpiece_temperature", "local_damage", "tool_chip", "backlash"]
    make_experiment(tmp_path, effects=hidden, seed=6305004, design=PartDesign(corners=True))
    report, _ = program_runs.diagnose(tmp_path)
    assert {(e["effect"], e["target"]) for e in report["effects"]} == {
        ("backlash", "Y"),
        ("component", "EXY"),
        ("tool_chip", "T1"),
        ("datum_shift", None),
        ("workpiece_temperature", None),
    }


def test_what_remains_elsewhere_is_no_doubt_about_a_local_effect(tmp_path):
    """Two of five effects are not found; a glitch of 9 um at few points is there all the same."""
    hidden = ["ambient_drift", "quadrant_glitch", "scale", "missing_table", "leaning_column"]
    make_experiment(tmp_path, effects=hidden, seed=4334021, noise="heavy_tails")
    report, _ = program_runs.diagnose(tmp_path)
    assert ("quadrant_glitch", "X") in {(e["effect"], e["target"]) for e in report["effects"]}


def test_a_chip_that_a_slip_stood_beside_moves_to_its_own_moment(tmp_path):
    """A slip and an earlier chip do most of what one chip does at the moment of the slip."""
    design = PartDesign(two_set_ups=True)
    make_experiment(tmp_path, effects=["tool_chip"], seed=55500100, design=design)
    report, _ = program_runs.diagnose(tmp_path)
    assert [(e["effect"], e["target"]) for e in report["effects"]] == [("tool_chip", "T1")]


@pytest.mark.parametrize(
    ("effects", "seed", "noise", "design"),
    [
        # where a tool entered a bore one point lies 10 um off: a chip took that up, and hid it
        (
            ["lateral_play", "tool_deflection", "missing_table"],
            4552038,
            "white",
            PartDesign(corners=True),
        ),
        # two points before the slip were taken for odd ones, and a glitch stood for the rest
        (["hysteresis", "spindle_growth", "tool_slip"], 4552001, "white", PartDesign()),
        # X turned 1.2 um before a point of either wall: three effects of 80 um stood for them
        (
            ["quadrant_glitch", "datum_shift", "local_damage"],
            4783001,
            "correlated",
            PartDesign(),
        ),
    ],
)
def test_odd_readings_neither_call_for_an_effect_nor_hide_one(
    tmp_path, effects, seed, noise, design
):
    make_experiment(tmp_path, effects=effects, seed=seed, design=design, noise=noise)
    report, _ = program_runs.diagnose(tmp_path)
    truth = json.loads((tmp_path / "truth.json").read_text())
    found = judge(report, truth)
    assert found.outcome in ("right", "class"), found.said
    assert found.named == found.true == len(effects) and not report["weak_effects"]


def test_heavy_tails_alone_name_no_effect(tmp_path):
    """Corners cut late would explain two of the readings that lie 7 u off."""
    make_experiment(tmp_path, effects=[], seed=5040004, noise="heavy_tails")
    report, _ = program_runs.diagnose(tmp_path)
    assert report["verdict"] == "nothing"


@pytest.mark.parametrize("noise", ["common", "correlated", "u_half"])
def test_what_readings_have_in_common_as_noise_is_no_failure_of_the_model(tmp_path, noise):
    make_experiment(tmp_path, effects=[], seed=7210004, noise=noise)
    report, _ = program_runs.diagnose(tmp_path)
    assert report["verdict"] == "nothing"
    # the smallest of some ten chances
    assert min([1.0, *(failure["p"] for failure in report["where_it_fails"])]) > 1e-4


def test_an_effect_that_cancels_a_form_comes_with_a_doubt(tmp_path):
    """A head that tilts by 119 urad +- 170, and a turn about Z, are each twice what was read."""
    hidden = ["head_tilt", "loose_gib"]
    make_experiment(tmp_path, effects=hidden, seed=15000296, noise="heavy_tails")
    report, _ = program_runs.diagnose(tmp_path)
    assert report["rms_um"]["after"] > report["rms_um"]["before"]
    (told,) = (note for note in report["note_records"] if note["kind"] == "cancelling")
    # the report gives four decimals
    assert told["size"] == pytest.approx(report["rms_um"]["after"], abs=1e-4)


def test_axes_that_never_turn_are_no_candidates(tmp_path):
    """Programs that turn A, B or C are refused, so no experiment can hide a rotary axis' place."""
    make_experiment(tmp_path, effects=[], seed=33)
    report, _ = program_runs.diagnose(tmp_path)
    status = [c["status"] for c in report["candidates"] if c["effect"] == "rotary_location"]
    assert status
    assert all(s.startswith("not testable") and "never turned" in s for s in status)
