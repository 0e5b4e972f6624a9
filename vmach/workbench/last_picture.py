"""The picture that a job showed last: it is there at once when the job is opened again.

Reading a job and predicting its part takes seconds. Where none of its files has changed, the page
gets the answers of the last time; the model confirms them as soon as it is ready.
"""

from __future__ import annotations

import contextlib
import hashlib
import json
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from vmach import __version__
from vmach.workbench.model.remote import RemoteModel

__all__ = ["LastPicture"]

#: what the page asks for until the part is drawn, with its usual arguments
_QUESTIONS: dict[str, dict[str, Any]] = {
    "about": {},
    "mesh": {},
    "values": {"quantity": "deviation", "model": "abbe", "changes": []},
}
#: jobs whose picture is kept; one takes about half a megabyte
_MOST = 12

Answer = tuple[dict[str, Any], bytes]


class LastPicture:
    """Answers about a job as it was, kept in the user's own state folder.

    They hold for one version of vmach, one control, and the content of all files of the job.

    Parameters
    ----------
    job : Path
    effect_files : sequence of Path
    control : str or None
    """

    def __init__(self, job: Path, effect_files: Sequence[Path], control: str | None) -> None:
        self._kind = f"{__version__}\0{control}\0"
        self._effect_files = list(effect_files)
        home = os.environ.get("XDG_STATE_HOME") or Path.home() / ".local" / "state"
        name = hashlib.sha256(str(job).encode()).hexdigest()[:32]
        self._file = Path(home) / "vmach" / "pictures" / f"{name}.picture"
        self._kept, self._seen = self._read(), dict[str, Answer]()
        self._is_written = bool(self._kept)

    @property
    def is_there(self) -> bool:
        """Whether there are answers that the model has not confirmed yet."""
        return bool(self._kept)

    @property
    def files(self) -> list[Path]:
        """The files of the job that it was made of."""
        return [Path(name) for name in self._kept["about"][0]["files"]] if self._kept else []

    def answer(self, question: str, arguments: Mapping[str, Any]) -> Answer | None:
        """The answer of the last time; None where there is none, or the question is another."""
        return self._kept[question] if self._kept and self._is_usual(question, arguments) else None

    def note(self, question: str, arguments: Mapping[str, Any], answer: Answer) -> None:
        """Keep an answer of the model for the next time; written as soon as all are there."""
        if self._is_written:
            return
        if question == "about" or ("about" in self._seen and self._is_usual(question, arguments)):
            self._seen[question] = answer
        if len(self._seen) == len(_QUESTIONS):
            self._write(self._seen)
            self._seen, self._is_written = {}, True

    async def holds(self, model: RemoteModel) -> bool:
        """Whether the model says the same; only what it says counts from then on.

        Raises
        ------
        ModelRefused, ModelStopped
        """
        before, self._kept = self._kept, {}
        if not before:
            return True
        found = {name: await model.ask(name, **usual) for name, usual in _QUESTIONS.items()}
        if all(_is_alike(found[name], before[name]) for name in _QUESTIONS):
            return True
        self._write(found)
        return False

    def _is_usual(self, question: str, arguments: Mapping[str, Any]) -> bool:
        known = self._kept or self._seen
        given = dict(arguments)
        tolerance_um = given.pop("tolerance_um", None)
        is_own = tolerance_um in (None, known["about"][0]["tolerance_um"])
        return is_own and given == _QUESTIONS.get(question)

    def _read(self) -> dict[str, Answer]:
        try:
            head, _, content = self._file.read_bytes().partition(b"\n")
            told = json.loads(head)
            answers: dict[str, Answer] = {}
            for question in _QUESTIONS:
                record, size = told["answers"][question]
                answers[question], content = (record, content[:size]), content[size:]
            return answers if told["stamp"] == self._stamp(answers) else {}
        except (OSError, ValueError, KeyError, TypeError):
            return {}

    def _write(self, answers: Mapping[str, Answer]) -> None:
        """Write them whole or not at all; where that cannot be, nothing is kept."""
        with contextlib.suppress(OSError):
            told = {name: (record, len(content)) for name, (record, content) in answers.items()}
            head = json.dumps({"stamp": self._stamp(answers), "answers": told}).encode()
            contents = [content for _, content in answers.values()]
            self._file.parent.mkdir(parents=True, exist_ok=True, mode=0o700)
            fresh = self._file.with_suffix(f".{os.getpid()}")
            fresh.write_bytes(b"".join([head, b"\n", *contents]))
            os.replace(fresh, self._file)
            self._forget_old()

    def _stamp(self, answers: Mapping[str, Answer]) -> str:
        """What they hold for, as one word."""
        digest = hashlib.sha256(self._kind.encode())
        for path in [*map(Path, answers["about"][0]["files"]), *self._effect_files]:
            digest.update(str(path).encode() + hashlib.sha256(path.read_bytes()).digest())
        return digest.hexdigest()

    def _forget_old(self) -> None:
        kept = self._file.parent.glob("*.picture")
        for path in sorted(kept, key=lambda path: -path.stat().st_mtime_ns)[_MOST:]:
            path.unlink(missing_ok=True)


def _is_alike(one: Answer, other: Answer) -> bool:
    return one[1] == other[1] and json.dumps(one[0]) == json.dumps(other[0])
