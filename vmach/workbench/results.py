"""Where results of the open job go."""

from __future__ import annotations

from pathlib import Path

from vmach.workbench.session import RESULTS, Session

__all__ = ["result_place"]


def result_place(session: Session, name: str, *, is_folder: bool = True) -> Path:
    """Where a result goes, seen from the opened folder; the folders above it are made.

    Raises
    ------
    InputError
        No job is open.
    """
    folder, job, _ = session.need_job()
    place = Path(RESULTS) / job.stem / name
    made = folder.inside(str(place if is_folder else place.parent))
    (made.parent if is_folder else made).mkdir(parents=True, exist_ok=True)
    return place
