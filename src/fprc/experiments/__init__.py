"""What the paper does, in memory: experiments, comparison, sweeps, closed loops."""
