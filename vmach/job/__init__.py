"""The job file: one machining job with its machine, program, stock, tools and nominal CAD."""

from vmach.job.job import Blank, Inspection, Job, JobTool, free_job_name, job_name, read_job
from vmach.job.probing import Probing

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
