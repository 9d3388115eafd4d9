"""The claims on families of simulated rigs: named, drawn, or compatible with the paper's tables."""
