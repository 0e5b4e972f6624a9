"""Custom macro B: expressions, variables, flow and calls."""
