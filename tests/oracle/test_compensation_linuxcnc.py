"""Compensated programs as LinuxCNC's interpreter reads them, all features of the golden programs.

Skipped where LinuxCNC is not installed. `test_compensation_corpus` does it for any folder.
"""

from pathlib import Path

import pytest

from tests.oracle.compensation_corpus import judged
from tests.oracle.linuxcnc_interpreter import is_installed

FOLDER = Path(__file__).parents[1] / "golden" / "gcode"
#: what cannot be compensated, by the reason that is given
REFUSED = {
    "cycle_spindle": "boring",
    "expressions": "turns to",
    "lathe_diameter": "diameter mode",
    "modal_state_m70": "M70",
    "probing": "probing",
    "splines": "spline",
    "threading": "threading",
}
PROGRAMS = sorted(p.stem for p in FOLDER.glob("*.canon"))

pytestmark = pytest.mark.skipif(not is_installed(), reason="LinuxCNC is not installed")


@pytest.mark.parametrize("name", PROGRAMS)
def test_accepted_with_the_intended_path(name, tmp_path):
    outcome = judged(tmp_path, FOLDER / f"{name}.ngc")
    if outcome.refusal:
        assert REFUSED.get(name, "turns to") in outcome.refusal
        return
    assert name not in REFUSED
    assert outcome.linuxcnc is None
    assert outcome.wrong == []
    assert outcome.worst_mm < 1.6e-3
