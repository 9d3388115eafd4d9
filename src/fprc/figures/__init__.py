"""Figures: arrays in, axes out. They are independent of rig and models."""
