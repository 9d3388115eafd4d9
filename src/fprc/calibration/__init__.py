"""Fit the simulated rig to the paper, and judge the claims on an ensemble of random rigs."""
