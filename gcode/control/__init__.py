"""One block after the other: modal groups, order of execution, program flow."""
