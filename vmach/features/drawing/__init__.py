"""What a drawing says: sizes, fits, tolerance frames."""
