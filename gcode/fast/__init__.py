"""Plain motion read by compiled code, equal to the interpreter to the bit."""
