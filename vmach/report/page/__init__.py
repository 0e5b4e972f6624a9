"""report.html and what every page shares."""
