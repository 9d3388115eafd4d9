"""The claims on families of simulated rigs: named rigs, and the ensemble."""
