"""Only loops that really have no end are refused as endless."""

from unittest.mock import patch

from hypothesis import given, settings
from hypothesis import strategies as st

from gcode import ProgramError, Source, read_program
from gcode.control.loop_guard import LoopGuard

CONDITIONS = ["#1 LT 5", "#1 NE 3", "#1 GE 0", "#2 LT 7", "[#1+#2] LT 9", "1", "0"]
STATEMENTS = ["#1=[#1+1]", "#1=[[#1+1] MOD 4]", "#2=[#2+#1]", "#1=0", "G1 X#1", "G1 X0 Y#2",
              "G91 G1 X1", "G90", "O9{} if [#1 GT 3]\nO{} break\nO9{} endif",
              "O9{} if [#2 GT 2]\nO{} continue\nO9{} endif", "O5 call [#2]"]  # fmt: skip
SUBROUTINE = "O5 sub\nO6 repeat [2]\nG1 X#1\n#2=[#2+1]\nO6 endrepeat\nO5 endsub\n"


@st.composite
def loops(draw, depth=0, number=1):
    """One WHILE loop, perhaps with another inside."""
    lines = [f"O{number} while [{draw(st.sampled_from(CONDITIONS))}]"]
    for index, statement in enumerate(draw(st.lists(st.sampled_from(STATEMENTS), max_size=4))):
        own = 10 * number + index
        lines.append(statement.format(own, number, own))
    if depth < 2 and draw(st.booleans()):
        lines.append(draw(loops(depth=depth + 1, number=number + 1)))
    return "\n".join([*lines, f"O{number} endwhile"])


def outcome(text):
    """Rows of the record, or the message of the refusal."""
    try:
        return len(read_program(Source(text.encode()), max_blocks=3000).record)
    except ProgramError as error:
        return error.what


@settings(max_examples=150, deadline=None)
@given(loops())
def test_a_loop_that_ends_is_obeyed_as_without_the_guard(loop):
    text = f"{SUBROUTINE}F100\n{loop}\nM2\n"
    with patch.object(LoopGuard, "jumped_back", lambda *_, **__: None):
        truth = outcome(text)
    guarded = outcome(text)
    if isinstance(guarded, str) and guarded.startswith("loop without end"):
        assert isinstance(truth, str) and truth.startswith("program runs more than")
    else:
        assert guarded == truth
