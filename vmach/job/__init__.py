"""The job file: one machining job with its machine, program, stock, tools and nominal CAD."""

from vmach.files.job_name import free_job_name, job_name
from vmach.job.blank import Blank
from vmach.job.inspection import Inspection
from vmach.job.job import Job
from vmach.job.probing import Probing
from vmach.job.reading import read_job
from vmach.job.tool import JobTool

__all__ = [
    "Blank",
    "Inspection",
    "Job",
    "JobTool",
    "Probing",
    "free_job_name",
    "job_name",
    "read_job",
]
