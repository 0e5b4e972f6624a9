"""accuracy.html: the page of a machine's volumetric accuracy."""
