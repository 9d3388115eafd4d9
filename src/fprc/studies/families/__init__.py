"""The claims on families of simulated rigs: named rigs, rigs near print, and drawn rigs."""
