"""One importer a file."""
