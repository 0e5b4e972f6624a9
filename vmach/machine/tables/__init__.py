"""Error tables: readings, runs, and the curves between them."""
