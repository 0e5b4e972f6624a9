"""Features of a part as a drawing asks for them: sizes, form, orientation, location."""
