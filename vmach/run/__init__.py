"""The main job, its inspection and what it writes."""
