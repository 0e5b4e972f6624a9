"""STEP files (ISO 10303-21): from the text to solids with exact faces."""
