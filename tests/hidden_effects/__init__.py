"""Experiments with a hidden effect, made without any code of the program that has to find it.

A random machine with known error curves cuts a random part while nature adds effects that the
error tables do not hold. Only files come out: the job as a user would have it, and the truth.
"""
