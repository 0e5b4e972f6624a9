"""Vocabulary against pygcode: which codes exist, and which exclude each other in a block."""

import warnings

import pytest

from gcode.state.codes import code_of

with warnings.catch_warnings():
    warnings.simplefilter("ignore")
    from pygcode import gcodes
    from pygcode.gcodes import MODAL_GROUP_MAP

#: Codes of axes that do not exist here (U V W planes).
ABSENT = {"G17.1", "G18.1", "G19.1"}
#: pygcode counts these otherwise than LinuxCNC: G5.3 ends G5.2 and is not a motion of its own.
OTHERWISE = {"G05.3"}


def subclasses(cls):
    for child in cls.__subclasses__():
        yield child
        yield from subclasses(child)


def group_here(word):
    code = code_of(word[0], round(10 * float(word[1:])))
    return None if code is None else code.group


@pytest.fixture(scope="module")
def pygcode_groups():
    names = {value: name for name, value in MODAL_GROUP_MAP.items()}
    found = {c for c in subclasses(gcodes.GCode) if c.word_key is not None}
    return {str(c.word_key): names.get(c.modal_group) for c in found}


def test_every_code_of_pygcode_is_known(pygcode_groups):
    assert {w for w in pygcode_groups if group_here(w) is None} == ABSENT


def test_same_modal_groups(pygcode_groups):
    pairs = {(group, group_here(word)) for word, group in pygcode_groups.items()
             if group is not None and word not in ABSENT | OTHERWISE}  # fmt: skip
    assert len(pairs) == len({theirs for theirs, _ in pairs}) == len({ours for _, ours in pairs})
