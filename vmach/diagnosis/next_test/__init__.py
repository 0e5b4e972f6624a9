"""What to measure next, and what these measurements cannot see."""
