"""diagnosis.html: the verdict, where the model fails, and what was looked for, in one file."""

from vmach.diagnosis.page.page import write_diagnosis_page

__all__ = [
    "write_diagnosis_page",
]
