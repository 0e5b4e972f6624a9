"""Files of a drawing's results for other programs and for the archive, one format a file."""
