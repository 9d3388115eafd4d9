"""Fit the simulated rig to the paper, and test the claims on an ensemble of random rigs."""
