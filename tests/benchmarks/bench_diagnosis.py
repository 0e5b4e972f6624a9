"""Count verdicts and coverage over simulated measurements of one job.

Usage: python tests/benchmarks/bench_diagnosis.py [JOB] [COUNT]

JOB (default samples/missing_effect) gives the design: program, points, uncertainty. Its readings
are replaced by the model's own plus noise, a draw of the tables' uncertainty, and nothing, one or
two effects, or a pattern that no effect makes. Effects are drawn from the library itself, so the
counts are an upper limit of what real causes give; experiments with independent causes are those
of bench_hidden_effects.py.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np

from vmach.diagnosis.diagnose import Diagnosis, diagnose
from vmach.diagnosis.inference.prepare import prepare_weighing
from vmach.diagnosis.residuals.job_survey import survey_job
from vmach.fit.survey import Survey

SAMPLE = Path(__file__).parents[2] / "samples" / "missing_effect"
#: smallest mean signal, in units of the noise, after alignment
VISIBLE = 1.0
#: effects whose sizes are drawn; flexible curves have no size
LEFT_OUT = {"component", "datum_shift", "reflector", "fixture", "ambient_drift"}


class Simulation:
    """Readings of one design with causes of known size."""

    def __init__(self, survey: Survey, seed: int) -> None:
        self.survey, self.weighing = survey, prepare_weighing(survey)
        self.random = np.random.default_rng(seed)
        self.factors = survey.factors
        weight = 1.0 / survey.u_mm[:, None]
        self.basis, _ = np.linalg.qr(survey.nuisance * weight)

    def noise_mm(self) -> np.ndarray:
        """Noise of the readings and one draw of what the tables do not know."""
        causes = self.random.standard_normal(self.factors.shape[1])
        noise = self.survey.u_mm * self.random.standard_normal(len(self.survey))
        return noise + self.factors @ causes

    def effect(self) -> tuple[str, str, dict[str, float], np.ndarray]:
        """An effect of usual size that the design can see: name, target, parameters, signal."""
        while True:
            c = self.weighing.candidates[self.random.integers(len(self.weighing.candidates))]
            if c.effect.name in LEFT_OUT or c.effect.rarity > 1.0:
                continue
            chance = np.exp(c.log_prior)
            place = self.random.choice(len(c.grid), p=chance / chance.sum())
            size = self.random.uniform(0.4, 2.0) * self.random.choice([-1.0, 1.0])
            coefficients = np.zeros(c.signatures_mm.shape[2])
            coefficients[0] = size
            signal = c.signatures_mm[:, place] @ coefficients
            white = signal / self.survey.u_mm
            white = white - self.basis @ (self.basis.T @ white)
            if np.sqrt(np.mean(white**2)) > VISIBLE:
                settled = c.effect.settle(coefficients, c.grid[place])
                return c.effect.name, c.target, settled, signal

    def foreign(self) -> np.ndarray:
        """A ripple through space in a random direction, along a random direction."""
        place = np.vstack([path.nose_mm for path in self.survey.paths])
        wave = self.random.standard_normal(3)
        wave *= 2 * np.pi / self.random.uniform(40.0, 150.0) / np.linalg.norm(wave)
        along = self.random.standard_normal(3)
        along *= self.random.uniform(3e-3, 8e-3) / np.linalg.norm(along)
        return np.sin(place @ wave) * (self.survey.sensing @ along)

    def diagnosed(self, signal_mm: np.ndarray) -> Diagnosis:
        """The diagnosis of noise plus signal."""
        readings = signal_mm + self.noise_mm()
        measurements = tuple(
            replace(m, measured_mm=m.predicted_mm + readings[own])
            for m, own in zip(self.survey.measurements, self.survey.rows, strict=True)
        )
        return diagnose(Survey(self.survey.job, measurements), like=self.weighing)


def count(simulation: Simulation, kind: str, number: int) -> None:
    """Print verdicts, how many are right, and how many intervals cover."""
    verdicts, right, covered, intervals = Counter(), 0, 0, 0
    start = time.perf_counter()
    for _ in range(number):
        wanted = [simulation.effect() for _ in range({"single": 1, "double": 2}.get(kind, 0))]
        signal = sum((w[3] for w in wanted), np.zeros(len(simulation.survey)))
        if kind == "foreign":
            signal = simulation.foreign()
        found = simulation.diagnosed(signal)
        verdicts[found.verdict] += 1
        right += is_right(kind, wanted, found)
        hit, total = coverage(wanted, found)
        covered, intervals = covered + hit, intervals + total
    seconds = (time.perf_counter() - start) / number
    line = f"{kind:8s} {number:4d} sets, {right:4d} right, {dict(verdicts)}, {seconds:.1f} s each"
    if intervals:
        line += f", 95 % intervals cover {covered} of {intervals}"
    print(line, flush=True)


def is_right(kind: str, wanted: list, found: Diagnosis) -> bool:
    """Whether a verdict says what was hidden."""
    if kind == "clean":
        return found.verdict == "nothing"
    if kind == "foreign":
        return found.verdict == "unknown"
    if found.verdict not in ("named", "class", "partly"):
        return False
    classes = [{f.name, *f.rivals.names} for f in found.findings]
    return all(any(name in c for c in classes) for name, *_ in wanted)


def coverage(wanted: list, found: Diagnosis) -> tuple[int, int]:
    """How many of the parameters that are shown have the truth in their 95 % intervals."""
    hit, total = 0, 0
    for name, target, truth, _ in wanted:
        for f in found.findings:
            if (f.name, f.target) != (name, target):
                continue
            for key, value in truth.items():
                if key in f.interval_95 and key not in f.weakly_identified:
                    low, high = f.interval_95[key]
                    if key == "phase_rad":  # the turn that is meant is the nearest
                        value += 2 * np.pi * np.round((f.parameters[key] - value) / (2 * np.pi))
                    total += 1
                    hit += low <= value <= high
    return hit, total


def main() -> None:
    """Run all four kinds."""
    job = Path(sys.argv[1]) if len(sys.argv) > 1 else SAMPLE
    number = int(sys.argv[2]) if len(sys.argv) > 2 else 25
    simulation = Simulation(survey_job(job), seed=5)
    weighing = simulation.weighing
    print(f"{job}: {len(simulation.survey)} readings, {len(weighing.candidates)} candidates")
    for kind in ("clean", "single", "double", "foreign"):
        count(simulation, kind, number)


if __name__ == "__main__":
    main()
