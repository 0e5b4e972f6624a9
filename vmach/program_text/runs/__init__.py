"""Plain lines of a program written anew in compiled code, many at once."""
