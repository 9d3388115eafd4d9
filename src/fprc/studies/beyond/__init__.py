"""Competitors of the paper's models on several worlds of simulated rigs."""
