"""The characteristics of ISO 1101 and ISO 14405-1, one family a file."""
