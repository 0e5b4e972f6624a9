"""The part as the workbench shows it, in a process of its own; `remote` is the way in."""
