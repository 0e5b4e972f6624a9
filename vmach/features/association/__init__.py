"""Ideal features laid through points: least squares, minimum zone, contacting."""
