"""A program's text taken apart and put together again with moved ends; the rest byte for byte."""

from vmach.program_text.blocks.block_modes import block_modes
from vmach.program_text.blocks.line_modes import LineModes
from vmach.program_text.blocks.pieces import Piece, Pieces, circle_through
from vmach.program_text.control import check_meaning, check_words, target_control
from vmach.program_text.expanding.expansion import Expanded, job_of_control, prepare_plain
from vmach.program_text.rewriter import Rewriter, Target, Written

__all__ = [
    "Expanded",
    "LineModes",
    "Piece",
    "Pieces",
    "Rewriter",
    "Target",
    "Written",
    "block_modes",
    "check_meaning",
    "check_words",
    "circle_through",
    "job_of_control",
    "prepare_plain",
    "target_control",
]
