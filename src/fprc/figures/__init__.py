"""Figures: arrays in, axes out. They know files and nothing of rig or models."""
