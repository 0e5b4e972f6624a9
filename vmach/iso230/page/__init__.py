"""iso230.html: a sheet for every evaluated table, to be signed."""
