"""The instruments of vmach, one class a file; a file that is put here is found."""
