"""A first job and machine file from a program, a nominal CAD and a few answers."""

from vmach.setup.kinematics import KINEMATICS, Kinematics
from vmach.setup.new_job import Answers, new_job

__all__ = ["KINEMATICS", "Answers", "Kinematics", "new_job"]
