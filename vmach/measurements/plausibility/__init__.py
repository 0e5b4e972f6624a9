"""Measurements that may be wrong by mistake: units, signs, axes, frames, clocks."""
