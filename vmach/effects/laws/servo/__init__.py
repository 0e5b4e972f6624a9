"""Laws of drives: lost motion, lag, inertia."""
