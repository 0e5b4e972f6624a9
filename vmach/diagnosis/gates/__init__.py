"""Gates that an explanation has to pass before anything is named."""
