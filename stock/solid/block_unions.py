"""Blocks of strokes united in processes of their own, one a core.

A union keeps the interpreter's lock, so threads would wait for each other. A block's union is
handed over as a mesh, which the caller cuts with. The bits do not depend on the number of
processes: every block is a mesh on its way, also where this process unites it. A process that
dies leaves its block to this one.

Source: the set operations are those of the library manifold3d.
"""

from __future__ import annotations

import contextlib
import pickle
import queue
import subprocess
import sys
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import BinaryIO

import numpy as np
from manifold3d import Manifold, Mesh64

from stock.child_process import children_may_die, isolated_python
from stock.solid.cutter_solids import CutterSolids
from stock.threads import cores_to_use

__all__ = ["block_unions"]


@dataclass(frozen=True)
class _Packed:
    """A solid as arrays, and the move of every run of its triangles."""

    arrays: dict[str, np.ndarray]
    tolerance: float
    move: np.ndarray


def block_unions(
    cutters: CutterSolids, blocks: Sequence[np.ndarray], done: Callable[[int], None]
) -> Iterator[Manifold]:
    """The union of every block of strokes, in order.

    Parameters
    ----------
    cutters : CutterSolids
        Learns the moves of the solids.
    blocks : sequence of (S,) int64
    done : callable
        Told how many strokes are finished, from any thread.
    """
    if len(blocks) == 1:
        yield cutters.union(blocks[0], done)
        return
    count = min(cores_to_use(), len(blocks))
    if count < 2:
        for block in blocks:
            yield _unpacked(_united(cutters, block, done), cutters)
        return
    with children_may_die(), contextlib.closing(_Team(cutters, count)) as team:
        waiting: deque[Future[_Packed]] = deque()
        for block in blocks:
            waiting.append(team.give(block, done))
            if len(waiting) > count:
                yield _unpacked(waiting.popleft().result(), cutters)
        while waiting:
            yield _unpacked(waiting.popleft().result(), cutters)


def _united(cutters: CutterSolids, block: np.ndarray, done: Callable[[int], None]) -> _Packed:
    """The union of a block by a maker of its own, so that nothing goes from block to block."""
    maker = CutterSolids(cutters.strokes, cutters.stacks, cutters.top_mm)
    solid = maker.union(block, done)
    mesh = solid.to_mesh64()
    names = ("vert_properties", "tri_verts", "merge_from_vert", "merge_to_vert", "run_index",
             "run_original_id", "face_id")  # fmt: skip
    arrays = {name: np.array(getattr(mesh, name)) for name in names}
    move = [maker.move_of_id[number] for number in arrays["run_original_id"].tolist()]
    return _Packed(arrays, solid.get_tolerance(), np.array(move, np.int64))


def _unpacked(packed: _Packed, cutters: CutterSolids) -> Manifold:
    """The solid; `cutters` learn its moves."""
    arrays = dict(packed.arrays)
    known, run = np.unique(arrays["run_original_id"], return_inverse=True)
    identity = Manifold.reserve_ids(len(known)) + np.arange(len(known))
    arrays["run_original_id"] = identity[run].astype(np.uint32)
    cutters.move_of_id |= dict(zip(identity[run].tolist(), packed.move.tolist(), strict=True))
    return Manifold(Mesh64(**arrays)).set_tolerance(packed.tolerance)


class _Team:
    """Processes that unite blocks, each with a thread here that waits for it."""

    def __init__(self, cutters: CutterSolids, count: int) -> None:
        self.cutters = replace(cutters, move_of_id={})
        told = pickle.dumps(self.cutters, pickle.HIGHEST_PROTOCOL)
        self.idle: queue.SimpleQueue[subprocess.Popen | None] = queue.SimpleQueue()
        self.all = [_hired() for _ in range(count)]
        self.threads, self.is_over = ThreadPoolExecutor(count), False
        for one in self.all:
            self.threads.submit(self._begin, one, told)

    def _begin(self, one: subprocess.Popen | None, told: bytes) -> None:
        if one is not None:
            with contextlib.suppress(OSError):
                one.stdin.write(told)
                one.stdin.flush()
        self.idle.put(one)

    def give(self, block: np.ndarray, done: Callable[[int], None]) -> Future[_Packed]:
        """A block for the next process that has nothing to do."""
        return self.threads.submit(self._work, block, done)

    def _work(self, block: np.ndarray, done: Callable[[int], None]) -> _Packed:
        one, told = self.idle.get(), 0
        try:
            if one is None:
                return _united(self.cutters, block, done)
            pickle.dump(block, one.stdin, pickle.HIGHEST_PROTOCOL)
            one.stdin.flush()
            while not isinstance(found := pickle.load(one.stdout), _Packed):
                told += found
                done(found)
            return found
        except (OSError, EOFError, pickle.UnpicklingError):  # it has died
            if self.is_over:
                raise
            done(-told)
            one = None
            return _united(self.cutters, block, done)
        finally:
            self.idle.put(one)

    def close(self) -> None:
        """End all processes, at once those that still work."""
        self.is_over = True
        for one in self.all:
            if one is not None:
                one.kill()
        self.threads.shutdown(cancel_futures=True)
        for one in self.all:
            if one is not None:
                one.communicate()


def _hired() -> subprocess.Popen | None:
    """A process that waits for blocks; None where there can be none."""
    try:
        return subprocess.Popen(isolated_python(__name__), stdin=subprocess.PIPE,
                                stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)  # fmt: skip
    except (OSError, ValueError):
        return None


def _live(door: BinaryIO, answers: BinaryIO) -> None:
    """A process: block after block until nobody is there any more."""

    def answer(what: object) -> None:
        pickle.dump(what, answers, pickle.HIGHEST_PROTOCOL)
        answers.flush()

    with contextlib.suppress(EOFError, OSError, KeyboardInterrupt):
        cutters = pickle.load(door)
        while True:
            answer(_united(cutters, pickle.load(door), answer))


if __name__ == "__main__":
    from stock.solid import block_unions as _own  # classes of the package, not of ``__main__``

    _own._live(sys.stdin.buffer, sys.stdout.buffer)
