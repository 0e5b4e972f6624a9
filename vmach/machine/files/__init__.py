"""Machine files: what stands in them, checked and read."""
