"""What cannot be rewritten word by word, written out first."""
