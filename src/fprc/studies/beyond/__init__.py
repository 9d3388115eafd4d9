"""Competitors of the paper's models on several families of simulated rigs."""
