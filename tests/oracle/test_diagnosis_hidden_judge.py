"""The judge of hidden-effect experiments: strict where it has to be."""

import pytest

from tests.hidden_effects.verdict import judge

LAG = {
    "name": "backlash", "target": "X", "accept": ["backlash"], "twins": [],
    "comparable": {"reversal_um": 6.0},
}  # fmt: skip
WARM = {
    "name": "workpiece_temperature", "target": None, "accept": ["workpiece_temperature"],
    "comparable": {},
    "twins": ["workpiece_temperature", "scale"],
}  # fmt: skip
STRETCHED = {
    "name": "scale", "target": "X", "accept": ["scale", "component EXX"], "twins": [],
    "comparable": {},
}  # fmt: skip

DENTED = {
    "name": "component", "target": "EXX", "accept": ["component"], "twins": [], "comparable": {},
}  # fmt: skip


def entry(label, *others):
    name, _, target = label.partition(" ")
    value = {"reversal_um": -5.9} if name == "backlash" else {}
    u = dict.fromkeys(value, 0.1)
    return {
        "effect": name, "target": target or None, "class": [name, *others],
        "parameters": value, "u": u,
    }  # fmt: skip


def outcome(hidden, *entries, verdict="named"):
    rms = {"before": 2.0, "after": 0.8, "expected_noise": 0.8}
    report = {"verdict": verdict, "effects": list(entries), "rms_um": rms}
    return judge(report, {"effects": hidden})


@pytest.mark.parametrize(
    ("hidden", "entries", "expected"),
    [
        ([LAG], [entry("backlash X")], "right"),
        ([LAG], [entry("backlash Y")], "wrong"),
        ([LAG], [entry("backlash X", "hysteresis")], "class"),
        ([LAG], [entry("backlash Y", "hysteresis")], "wrong"),
        ([LAG], [entry("hysteresis X", "backlash")], "class"),
        ([LAG], [entry("hysteresis X")], "wrong"),
        ([LAG], [entry("backlash X", *"abcde")], "vague"),
        ([LAG], [entry("backlash X"), entry("scale Y")], "extra"),
        ([WARM], [entry("workpiece_temperature")], "alone"),
        ([WARM], [entry("workpiece_temperature", "scale")], "class"),
        ([WARM], [entry("workpiece_temperature", "tool_radius")], "alone"),
        ([WARM], [entry("scale X", "workpiece_temperature")], "class"),
        ([STRETCHED], [entry("component EXX")], "right"),
        ([STRETCHED], [entry("component EYY")], "wrong"),
        ([LAG, STRETCHED], [entry("backlash X")], "part"),
        ([LAG, STRETCHED], [entry("scale X"), entry("backlash X")], "right"),
        ([LAG, STRETCHED], [entry("scale X"), entry("hysteresis X", "backlash")], "class"),
        ([LAG, STRETCHED], [entry("scale X"), entry("hysteresis X")], "wrong"),
        ([STRETCHED, DENTED], [entry("component EXX")], "right"),
        ([STRETCHED, DENTED], [entry("component EXX"), entry("backlash X")], "extra"),
        ([STRETCHED, LAG], [entry("component EXX")], "part"),
        ([STRETCHED, DENTED], [entry("scale X")], "part"),
        ([], [entry("scale X")], "wrong"),
    ],
)
def test_named_effects_are_held_against_the_truth(hidden, entries, expected):
    assert outcome(hidden, *entries).outcome == expected


def test_silence_is_right_for_a_healthy_machine_only():
    assert outcome([], verdict="nothing").outcome == "right"
    assert outcome([], verdict="unknown").outcome == "wrong"
    assert outcome([LAG], verdict="nothing").outcome == "nothing"
    assert outcome([LAG], verdict="unknown").outcome == "unknown"
    foreign = {"name": "ripple", "target": None, "accept": ["unknown"], "twins": []}
    assert outcome([foreign], verdict="unknown").outcome == "right"
    assert outcome([foreign, LAG], verdict="unknown").outcome == "unknown"
    assert outcome([foreign], entry("scale X")).outcome == "wrong"


def test_a_size_of_free_sign_is_turned_with_its_interval():
    (row,) = outcome([LAG], entry("backlash X")).parameters
    assert row[0] == "reversal_um"
    assert row[1:] == pytest.approx((5.9, 5.704, 6.096, 6.0), rel=1e-9)
