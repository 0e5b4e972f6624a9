"""Everything that a job lacks, has wrong or leaves doubtful, found in one go."""

from vmach.checkup.finding import Finding, Weight
from vmach.checkup.job_checkup import check_job

__all__ = ["Finding", "Weight", "check_job"]
