"""Fit the simulated rig to the paper."""
