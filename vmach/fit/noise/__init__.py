"""What stands beside effects: noise of readings, the measuring machine, what nobody models."""
