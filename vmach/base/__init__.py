"""What every other room may use: units, variants, progress, compiled kernels."""
