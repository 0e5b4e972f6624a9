"""What the builder of a machine adds to the control, and a program's text does not hold.

Subprograms, variables (GUD), machine data and M codes: the job says what they are, and what it does
not say is refused once, all together.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import TYPE_CHECKING

from gcode.dialects.sinumerik.block_words import ADDRESSES
from gcode.dialects.sinumerik.codes import M_CODES, NO_MOTION, OWN_ASSIGNED, REFUSED
from gcode.dialects.sinumerik.statements import subprogram_call
from gcode.dialects.sinumerik.values.expressions import WORDS
from gcode.dialects.sinumerik.values.held_data import HELD
from gcode.errors import ProgramError

if TYPE_CHECKING:
    from gcode.dialects.sinumerik.reader import SinumerikReader

__all__ = ["unknown_words"]

_VARIABLE = re.compile(
    r"(?<![A-Z0-9_$])(\$?[A-Z_][A-Z_]\w*)\s*(\[(?:[^\[\]]|\[[^\[\]]*\])*\])?\s*(\(|=(?!=))?",
    re.IGNORECASE,
)
_M_CODE = re.compile(r"(?<![A-Z0-9_$])M(\d+)(?![\d.]*\s*[=\[(])", re.IGNORECASE)
#: the control's own, which no job can leave out; cycles 960 to 999 measure
_CUTS = re.compile(r"RET|M17|(?!CYCLE9[6-9]\d)CYCLE\d+|HOLES\d|POCKET\d|SLOT\d|LONGHOLE|MEAS\w*")
_STEP = re.compile(r"[EF]_[A-Z]\w*")  #: E_MI_PL, F_DRILL
_STRING = re.compile(r"\"[^\"]*\"")
_LABELS = re.compile(
    r"\b(?:GOTO[FBCS]?|REPEATB?|CALL|PROC|EXTERN|DEF|MSG|WRITE|DELETE|GROUP_\w+)\b.*", re.IGNORECASE
)
_WORDS = {*ADDRESSES, *NO_MOTION, *OWN_ASSIGNED, *REFUSED, *WORDS, "IF", "ELSE", "ENDIF",
          "WHILE", "ENDWHILE", "FOR", "ENDFOR", "LOOP", "ENDLOOP", "REPEAT", "UNTIL", "CASE",
          "OF", "TO", "DEFAULT", "SUPA", "CIP", "CT", "RET", "TRANS", "ATRANS",
          "ROT", "AROT", "SCALE", "ASCALE",
          "MIRROR", "AMIRROR", "MCALL", "PCALL", "EXTCALL", "ENDLABEL", "AC", "IC"}  # fmt: skip


def unknown_words(
    reader: SinumerikReader, *, call: str = "", variable: str = "", m_code: int | None = None
) -> ProgramError:
    """One error for all that the machine's builder made and the job does not say.

    Parameters
    ----------
    reader : SinumerikReader
    call, variable, m_code : str, str, int
        What was met.
    """
    if _STEP.fullmatch(call):
        return ProgramError(f"{call} (a work step of ShopMill) is not read",
                            hint="post the program as G code")  # fmt: skip
    calls = dict.fromkeys([call] if call else [])
    calls |= dict.fromkeys(_unknown_calls(reader))
    variables = dict.fromkeys([variable] if variable else [])
    variables |= dict.fromkeys(_unknown_variables(reader))
    said = {int(code) for text in _texts(reader) for code in _M_CODE.findall(text)}
    said |= {m_code} if m_code is not None else set()
    codes = sorted(said - {*M_CODES, *reader.options.control.ignore_m})
    what, accepted = [], []
    if calls:
        what.append(f"subprograms {', '.join(calls)}")
        listed = ", ".join(f"'{name}'" for name in calls)
        accepted.append(f"ignore_calls = [{listed}], if they move nothing")
        accepted.append(f"{', '.join(f'{name}.SPF' for name in calls)} beside the program "
                        "or in subprograms = '...'")  # fmt: skip
    if variables:
        what.append(f"variables {', '.join(variables)}")
        listed = ", ".join(f"'{name}' = ..." for name in variables)
        accepted.append(f"variables = {{ {listed} }}")
    if codes:
        what.append(f"M codes {' '.join(f'M{code}' for code in codes)}")
        accepted.append(f"ignore_m = [{', '.join(map(str, codes))}], if they move nothing")
    return ProgramError(
        f"the program needs what the machine's builder made: {'; '.join(what)}",
        accepted=f"in [control]: {'; '.join(accepted)}",
    )


def _texts(reader: SinumerikReader) -> Iterator[str]:
    """Blocks of the program without comments and strings."""
    for index in range(len(reader.lines)):
        head, content = reader.content(index)
        is_head = content.startswith("%")  # %_N_PART_MPF
        if content and not is_head and not ("/" in head.group() and reader.options.skips(1)):
            yield _STRING.sub("", content)


def _unknown_calls(reader: SinumerikReader) -> Iterator[str]:
    for index in range(len(reader.lines)):
        match = subprogram_call(reader.content(index)[1])
        if match is not None and not reader.flow.is_flow(reader.content(index)[1]):
            name = match[2].upper()
            is_known = name in _WORDS or _CUTS.fullmatch(name) or reader.subprograms.is_there(name)
            if not is_known and not reader.options.control.ignores(name):
                yield name


def _unknown_variables(reader: SinumerikReader) -> Iterator[str]:
    texts = list(_texts(reader))
    given: set[str] = set()
    for text in texts:
        if re.match(r"(?:DEF|PROC)\b", text, re.IGNORECASE):
            given |= {word.upper() for word in re.findall(r"[A-Z_]\w+", text, re.IGNORECASE)}
        given |= {m[1].upper() for m in _VARIABLE.finditer(text) if m[3] == "=" and m[1][0] == "_"}
    calls = {m[2].upper() for m in map(subprogram_call, texts) if m is not None}
    for text in texts:
        for name, index, behind in _VARIABLE.findall(_LABELS.sub("", text)):
            bare = name.upper()
            known = bare in _WORDS or bare in given or bare in calls or _CUTS.fullmatch(bare)
            if known or behind == "(":
                continue
            if behind == "=" and HELD.fullmatch(bare):
                continue
            whole = bare + re.sub(r"\s", "", index).upper()
            if not reader.variables.knows(whole):
                yield whole
