"""One file each: the controls whose programs are read and written."""
