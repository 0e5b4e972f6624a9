"""Laws of the workpiece and of measuring it: datum, temperature, probe."""
