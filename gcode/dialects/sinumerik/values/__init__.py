"""Values of SINUMERIK: expressions, variables, and data that the control holds."""
