"""The text of a program: exact bytes, words, expressions and parameters."""
