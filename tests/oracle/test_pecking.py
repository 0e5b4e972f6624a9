"""Pecks of G73 and G83 on FANUC and on Haas.

FANUC B-64484EN-2, "Peck drilling cycle"; Haas Mill Operator's Manual 96-8000 (June 1999), G73, G83.
"""

import pytest

from tests.oracle.test_fanuc_manual import places, read, refusal


# Haas 96-8000 p. 191 (June 1999): "The first pass will cut in by I, each succeeding cut will be
# reduced by amount J, and the minimum cutting depth is K"; "L Number of repeats"
@pytest.mark.parametrize(
    ("words", "bottoms"),
    [("I8. J2. K3.", [-6, -12, -16, -19, -20]), ("I8. J0. K8.", [-6, -14, -20]),
     ("I30. J2. K3.", [-20]), ("I4. J9. K4.", [-2, -6, -10, -14, -18, -20]),
     ("Q5.", [-3, -8, -13, -18, -20])],
)  # fmt: skip
@pytest.mark.parametrize("cycle", ["G83", "G73"])
@pytest.mark.parametrize("fast", [False, True])
def test_haas_pecks(cycle, words, bottoms, fast):
    text = f"O1\nG21 G0 X0. Y0. Z50.\nG98 {cycle} X1. Z-20. R2. {words} F100.\nG80\nM30\n"
    moves = read(text, "haas", tools={}, fast=fast).moves
    assert moves.end_mm[moves.at_feed, 2].tolist() == pytest.approx(bottoms)


def test_haas_clears_the_chips_when_the_pecks_of_g73_come_to_k():
    """96-8000, G73: K beside Q, out to R when the passes total up to K."""
    text = "O1\nG21 G0 X0. Y0. Z50.\nG98 G73 X1. Z-28. R2. Q5. K10. F100.\nG80\nM30\n"
    levels = [z for _, _, z in places(text, "haas", tools={})]
    assert levels == [50, 2, -3, -1.73, -8, 2, -6.73, -13, -11.73, -18, 2, -16.73, -23, -21.73,
                      -28, 50]  # fmt: skip


@pytest.mark.parametrize("fast", [False, True])
@pytest.mark.parametrize(
    ("words", "dialect", "says"),
    [("G83 X1. Z-9. R2. F9.", "fanuc", "G83 without Q"),  # alarm PS0045
     ("G73 X1. Z-9. R2. Q0 F9.", "fanuc", "G73 without Q"),
     ("G83 X1. Z-9. R2. I3. J1. K1. F9.", "fanuc", "--control haas"),
     ("G83 X1. Z-9. R2. F9.", "haas", "G83 without Q"),
     ("G83 X1. Z-9. R2. Q1. I3. J1. K1. F9.", "haas", "Q beside I J K"),
     ("G83 X1. Z-9. R2. I3. J1. F9.", "haas", "G83 without Q"),
     ("G83 X1. Z-9. R2. K1. F9.", "haas", "without Q or I"),
     ("G81 X1. Z-9. R2. K3 F9.", "haas", "K word in G81")],
)  # fmt: skip
def test_pecks_that_nothing_says_are_refused(words, dialect, says, fast):
    assert says in refusal(f"O1\nG21 G0 Z50.\n{words}\nM30\n", dialect, fast=fast)
