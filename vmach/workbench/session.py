"""What is open: one job of one folder, its model, the work at hand, and who looks at it."""

from __future__ import annotations

import asyncio
import contextlib
import os
import time
from collections.abc import Callable, Hashable, Iterable
from pathlib import Path
from typing import Any

from vmach.errors import InputError
from vmach.files.job_name import job_name
from vmach.workbench.command_runs import CommandRun, CommandRuns
from vmach.workbench.events import Events
from vmach.workbench.file_watch import FileWatch
from vmach.workbench.job_chain import job_chain
from vmach.workbench.kept_results import KeptResults, content_of
from vmach.workbench.last_picture import LastPicture
from vmach.workbench.model.named_files import named_files
from vmach.workbench.model.remote import ModelRefused, ModelStopped, RemoteModel
from vmach.workbench.opened_folder import OpenedFolder
from vmach.workbench.recent_jobs import remember_job
from vmach.workbench.steps_back import Step, StepsBack

__all__ = ["RESULTS", "Session", "changed_since", "contents_of"]

#: where results lie beside the jobs, as on the command line
RESULTS = "vmach-results"
#: how often files are looked at
_WATCH_S = 0.5


class Session:
    """The state of the workbench; all of it but the sliders is in files.

    Attributes
    ----------
    folder : OpenedFolder or None
    job : Path or None
        The open job, in the folder.
    changes : list
        What the what-if sliders say, the same in all tabs.
    events : Events
    runs : CommandRuns or None
    other : Path or None
        A job beside the open one, to compare with.
    other_part : Path or None
        The job of another measured part of the same machine, on which the chain is checked.
    control : str or None
        That the programs are read for, in place of the job's.
    """

    def __init__(self, control: str | None = None) -> None:
        self.folder: OpenedFolder | None = None
        self.job: Path | None = None
        self.changes: list[dict[str, Any]] = []
        self.events = Events()
        self.runs: CommandRuns | None = None
        self.own_effects: list[Path] = []
        self.revision = 0
        self.steps = StepsBack(self._tell_steps)
        self._shown: dict[Path | None, dict[str, Any]] = {}
        self._kept: KeptResults | None = None
        self.other: Path | None = None
        self.other_part: Path | None = None
        self._other_model: RemoteModel | None = None
        self.control = control
        self._model: RemoteModel | None = None
        self._picture: LastPicture | None = None
        self._started_ns = 0
        self._watch, self._part_watch = FileWatch(), FileWatch()

    def open(self, job: Path) -> None:
        """Open a job, and its folder if that is not open.

        Raises
        ------
        InputError
            There is no such file.
        """
        job = Path(os.path.realpath(job / "job.toml" if job.is_dir() else job))
        if not job.is_file():
            raise InputError("no such job file", file=job)
        folder = OpenedFolder(job.parent)
        if self.folder != folder:
            self.open_folder(folder)
            self.job = None  # no step leads from one folder into another
        self._step_to(job)
        self.own_effects = [f for f in self.own_effects if f.is_file()]
        remember_job(job)
        self._start_model()
        self.events.tell("job", **self.record())

    def work_that_ends_with(self, job: Path) -> list[str]:
        """Kinds of the runs that opening a job would end: those of another folder."""
        if self.folder is None or self.runs is None or job.resolve().parent == self.folder.root:
            return []
        return [run.kind for run in self.runs.runs if not run.is_over]

    def open_next(self, *jobs: Path, after: Path) -> bool:
        """Open the last of the jobs that were made of the job `after`, if that is still open.

        The way there is one step for each of them, and so is the way back.
        """
        if self.job != after or not jobs:
            return False
        for job in jobs[:-1]:
            self._step_to(job)
        self.open(jobs[-1])
        return True

    def _step_to(self, job: Path) -> None:
        """Let this be the open job from now on, and note the way back; its model is not started."""
        if self.job is not None and self.job != job:
            before, sliders = self.job, self.changes
            back = lambda: (self.open(before), self.set_changes(sliders))  # noqa: E731
            self.steps.did(Step(_word_for(job), back, lambda: self.open(job)))
        self.job, self.changes = job, []

    async def check_job(self, job: Path) -> None:
        """Refuse a job that cannot be read, or whose part cannot be predicted.

        Raises
        ------
        ModelRefused, ModelStopped
        """
        model = RemoteModel(job, (), self.control)
        try:
            await model.ask("about")
        finally:
            model.close()

    def set_changes(
        self, changes: list[dict[str, Any]], *, tab: str = "", gesture: Hashable = None
    ) -> None:
        """What the sliders of What if say from now on; `tab` moved them."""
        before = self.changes
        if changes == before:
            return
        self.changes = changes
        self.steps.did(Step(
            _moved(before, changes), lambda: self.set_changes(before),
            lambda: self.set_changes(changes), (tab, gesture) if gesture else None,
        ))  # fmt: skip
        self.events.tell("changes", changes=changes, tab=tab)

    def open_folder(self, folder: OpenedFolder) -> None:
        """Open a folder; work in another one ends."""
        if self.runs is not None:
            self.runs.close()
        if self.other is not None:
            self.compare_with(None)
        self.folder, self.own_effects = folder, []
        self.check_on(None, since_ns=0)
        self.steps.forget()
        self._shown, self._kept = {}, KeptResults(folder.root, folder.root / RESULTS)
        self.runs = CommandRuns(folder.root, self._tell_run)

    @property
    def shown(self) -> dict[str, Any]:
        """What was found about the open job, by its kind."""
        return self._found(None) | self._found(self.job)

    def show(
        self, kind: str, found: dict[str, Any], job: Path | None = None, *, step: str = ""
    ) -> None:
        """Keep what was found about a job, or about its chain, and tell it to the tabs.

        With a name for the `step`, it can be undone: what was shown before is shown again.
        """
        before = self._found(job).get(kind)
        self._show(kind, found, job)
        if step:
            back, again = (
                lambda what=what: self._show(kind, what, job) for what in (before, found)
            )
            self.steps.did(Step(step, back, again))

    def check_on(self, part: Path | None, *, since_ns: int) -> None:
        """Check the chain on another measured part from now on, and watch its files.

        Parameters
        ----------
        part : Path or None
            Its job.
        since_ns : int
            When it was about to be read, as in `FileWatch.watch`.
        """
        self.other_part = part
        self._part_watch.watch([] if part is None else named_files(part), since_ns=since_ns)

    def contents(self) -> dict[Path, str | None]:
        """What the files of the open job hold now, a word for each; None where one is not there."""
        return contents_of([*self._watch.watched, *self.effect_files])

    def _found(self, job: Path | None) -> dict[str, Any]:
        """What was found about a job, or about the chain; at first what its files say."""
        if job not in self._shown and self._kept is not None:
            self._shown[job] = self._kept.read("" if job is None else self._name_of(job))
        return self._shown.setdefault(job, {})

    def _show(self, kind: str, found: dict[str, Any] | None, job: Path | None) -> None:
        self._found(job)[kind] = found
        if job in (None, self.job):
            self.events.tell("shown", **{kind: found})
        if self._kept is not None and self.job is not None:
            chain = [] if job else [step.job for step in job_chain(self.job)]
            checked_on = (
                named_files(self.other_part) if kind == "history" and self.other_part else []
            )
            of_job = self._watch.files if job in (None, self.job) else named_files(job)
            named = dict.fromkeys([*of_job, *chain, *checked_on])
            files = [path for path in named if path.is_file()]
            self._kept.keep("" if job is None else self._name_of(job), kind, found, files)

    def _name_of(self, job: Path) -> str:
        return self.folder.name_of(job) if self.folder else str(job)

    @property
    def effect_files(self) -> list[Path]:
        """Files of the user's own effects: those of the chain of jobs, and those written here."""
        files = (*_files_of_chain(self.job), *self.own_effects)
        return list(dict.fromkeys(path.resolve() for path in files))

    @property
    def loose_effects(self) -> list[Path]:
        """Files of own effects that were written or checked here and are in no job of the chain."""
        needed = _files_of_chain(self.job)
        return [path for path in self.own_effects if path.resolve() not in needed]

    def know_effect(self, path: Path) -> None:
        """Let the commands know the file of an own effect from now on."""
        if path not in self.own_effects:
            self.own_effects.append(path)
        self.events.tell("job", **self.record())

    def drop_effect(self, path: Path) -> None:
        """Let no command know the file of an own effect any more; the file stays.

        Raises
        ------
        InputError
            The job needs it, or it is not known.
        """
        if path not in self.loose_effects:
            names = ", ".join(file.name for file in self.loose_effects)
            raise InputError(
                f"{path.name} cannot be dropped", accepted=names or "a file that was not added",
                hint="Undo leaves a job that has the effect",
            )  # fmt: skip
        before = list(self.own_effects)
        after = [file for file in before if file != path]
        self.steps.did(Step(
            f"drop of {path.name}", lambda: self._know_all(before), lambda: self._know_all(after)
        ))  # fmt: skip
        self._know_all(after)

    def _know_all(self, files: list[Path]) -> None:
        self.own_effects = list(files)
        self.forget_check()
        self.reload()

    def forget_check(self) -> None:
        """Say no more what a check said: its text is not what it was, or is not known."""
        if self.runs is not None:
            self.runs.forget("check")
            self.events.tell("job", **self.record())

    @property
    def model(self) -> RemoteModel:
        """The process that holds the part.

        Raises
        ------
        InputError
            No job is open.
        """
        if self._model is None:
            raise InputError("no job is open", hint="choose one on the start page")
        return self._model

    async def ask(self, question: str, **arguments: Any) -> tuple[dict[str, Any], bytes]:
        """An answer of the model.

        Where its process has ended, another one is started and answers, so that nobody notices;
        but not in place of one that never answered, and once for a question.

        Raises
        ------
        ModelRefused, ModelStopped, InputError
        """
        may_start = True
        while True:
            model, picture = self.model, self._picture
            if picture is not None and (known := picture.answer(question, arguments)):
                return known
            try:
                found = await model.ask(question, **arguments)
                if picture is not None and model is self._model:
                    picture.note(question, arguments, found)
                return found
            except ModelStopped:
                if model is not self._model and self._model is not None:  # another job is open now
                    continue
                if not (may_start and model.has_answered) or self._model is None:
                    raise
                may_start = False
                self.reload()

    def compare_with(self, job: Path | None) -> None:
        """Load another job beside the open one; None puts it away."""
        if self._other_model is not None:
            self._other_model.close()
        before = self.other
        if before != job:
            word = "end of comparison" if job is None else f"comparison with {job_name(job)}"
            self.steps.did(Step(
                word, lambda: self.compare_with(before),
                lambda: self.compare_with(job),
            ))  # fmt: skip
        self.other, self._other_model = job, None
        if job is not None:
            files = {f for s in job_chain(job) for f in s.effect_files.values() if f.is_file()}
            self._other_model = RemoteModel(job, sorted(files), self.control)
        self.events.tell("other", job=None if job is None else str(job))

    async def ask_other(self, question: str, **arguments: Any) -> tuple[dict[str, Any], bytes]:
        """An answer about the job beside.

        Raises
        ------
        ModelRefused, ModelStopped, InputError
        """
        if self._other_model is None:
            raise InputError("no job is beside the open one", hint="choose one to compare with")
        return await self._other_model.ask(question, **arguments)

    def need_job(self) -> tuple[OpenedFolder, Path, CommandRuns]:
        """Folder, job and runs.

        Raises
        ------
        InputError
            No job is open.
        """
        if self.folder is None or self.job is None or self.runs is None:
            raise InputError("no job is open", hint="choose one on the start page")
        return self.folder, self.job, self.runs

    def reload(self) -> None:
        """Read the job's files again."""
        if self.job is not None:
            self._start_model()
            self.events.tell("job", **self.record())

    def record(self) -> dict[str, Any]:
        """What every tab shows alike."""
        if self.folder is None or self.job is None:
            return {"job": None, "revision": self.revision, "runs": []}
        return {
            "job": self.folder.name_of(self.job),
            "name": job_name(self.job),
            "folder": str(self.folder.root),
            "revision": self.revision,
            "changes": self.changes,
            "chain": [
                {
                    "job": self.folder.name_of(step.job),
                    "added": list(step.added),
                    "before_um": step.before_um,
                    "after_um": step.after_um,
                    "is_later": step.is_later,
                    "is_open": step.job == self.job,
                }
                for step in job_chain(self.job)
            ],
            "runs": [run.record() for run in self.runs.runs] if self.runs else [],
            "own_effects": [self.folder.name_of(path) for path in self.effect_files],
            "loose_effects": [self.folder.name_of(path) for path in self.loose_effects],
            "shown": self.shown,
            "other": None if self.other is None else str(self.other),
            "other_part": None if self.other_part is None else str(self.other_part),
            "steps": self.steps.record(),
        }

    async def keep_watch(self, evaluate_again: Callable[[], object]) -> None:
        """Reload the job whenever one of its files changes, until this is cancelled.

        `evaluate_again` starts to evaluate the chain; it is called when the other part changes.
        """
        is_due = False
        while True:
            await asyncio.sleep(_WATCH_S)
            changed = self._watch.changed()
            if changed and self.job is not None:
                names = [path.name for path in changed]
                self._shown.pop(self.job, None)  # it was about other files
                self.events.tell("files", names=names)
                self.reload()
            is_due |= self._has_changed_part()
            if is_due and not self._is_at_work("history"):
                is_due = False
                with contextlib.suppress(InputError):
                    evaluate_again()

    def _has_changed_part(self) -> bool:
        """Whether the other part's files have changed; the curve shows nothing of it then."""
        changed = self._part_watch.changed()
        if not changed or self.other_part is None:
            return False
        self.check_on(self.other_part, since_ns=time.time_ns())
        self._found(None)["history"] = old = {"steps": [], "other_part": str(self.other_part)}
        self.events.tell("shown", history=old)
        return True

    def _is_at_work(self, kind: str) -> bool:
        return self.runs is not None and any(
            run.kind == kind and not run.is_over for run in self.runs.runs
        )

    def close(self) -> None:
        """End all work."""
        self.events.close()
        if self.runs is not None:
            self.runs.close()
        for model in (self._model, self._other_model):
            if model is not None:
                model.close()
        self._model = self._other_model = None

    def _start_model(self) -> None:
        assert self.job is not None
        if self._model is not None:
            self._model.close()
        self.revision += 1
        self._started_ns = time.time_ns()
        self._model = RemoteModel(self.job, self.effect_files, self.control)
        self._picture = LastPicture(self.job, self.effect_files, self.control)
        files = [*named_files(self.job), *self._picture.files, *self.effect_files]
        self._watch.watch(files, since_ns=self._started_ns)
        with contextlib.suppress(RuntimeError):  # no loop yet: the first question does it
            asyncio.get_running_loop().create_task(self.watch_files())

    async def watch_files(self) -> None:
        """Watch all files that the open job depends on, and confirm what was shown of it."""
        model, picture = self._model, self._picture
        if model is None or picture is None:
            return
        is_good = not picture.is_there
        with contextlib.suppress(ModelRefused, ModelStopped):
            about, _ = await model.ask("about")
            if model is self._model:
                files = [*map(Path, about["files"]), *self.effect_files]
                self._watch.watch(files, since_ns=self._started_ns)
            is_good = await picture.holds(model)
        if not is_good and model is self._model:
            self._picture = None
            self.revision += 1
            self.events.tell("job", **self.record())

    def _tell_steps(self) -> None:
        self.events.tell("steps", **self.steps.record())

    def _tell_run(self, run: CommandRun) -> None:
        self.events.tell("run", **run.record())


def _files_of_chain(job: Path | None) -> list[Path]:
    """Files of own effects that a job and those before it have."""
    chain = [] if job is None else [step for step in job_chain(job) if not step.is_later]
    files = [file for step in chain for file in step.effect_files.values()]
    return [file.resolve() for file in files if file.is_file()]


def _content(path: Path) -> str | None:
    try:
        return content_of(path)
    except OSError:
        return None


def contents_of(files: Iterable[Path]) -> dict[Path, str | None]:
    """What files hold now, a word for each; None where one is not there."""
    return {path: _content(path) for path in files}


def changed_since(before: dict[Path, str | None]) -> list[Path]:
    """Files that hold something else than they did."""
    return [path for path, content in before.items() if _content(path) != content]


def _word_for(job: Path) -> str:
    """What opening a job did, for people."""
    last = [step for step in job_chain(job) if not step.is_later][-1]
    return "+ " + ", ".join(last.added) if last.added else f"open {job.name}"


def _moved(before: list[dict[str, Any]], after: list[dict[str, Any]]) -> str:
    """Which sliders differ, for people."""
    differing = [one for one in (*before, *after) if one not in before or one not in after]
    names = [_slider_word(one) for one in differing if isinstance(one, dict)]
    return ", ".join(dict.fromkeys(names)) or "sliders"


def _slider_word(one: dict[str, Any]) -> str:
    words = [one.get("component") or one.get("effect"), one.get("target")]
    return " ".join(str(word)[:40] for word in words if word)
