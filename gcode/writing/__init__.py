"""How the blocks of a program are written: numbers, words, labels, and edits of one line."""
