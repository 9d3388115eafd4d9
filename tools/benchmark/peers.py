"""The network of an ESN in other libraries, with the same weights, from state 0."""

from collections.abc import Callable
from importlib import import_module

import numpy as np

from fprc.models import EchoStates

#: From a log to x(k+1) of each sample k, and from one more sample to x after it, if it can.
Peer = tuple[Callable[[np.ndarray], np.ndarray], Callable[[np.ndarray], np.ndarray] | None]


def reservoirpy(features: EchoStates) -> Peer:
    """Return ReservoirPy's network; its leak is 1 - gamma."""
    network = import_module("reservoirpy.nodes").Reservoir(
        W=features.W_r_, Win=features.w_in_, bias=np.zeros(features.r), lr=1.0 - features.gamma
    )
    network.initialize(np.zeros((1, features.w_in_.shape[1])))

    def states(X: np.ndarray) -> np.ndarray:
        network.reset()
        return np.asarray(network.run(X))

    return states, lambda theta: np.asarray(network.step(theta))


def jax_scan(features: EchoStates) -> Peer:
    """Return Eq. (3) under ``jax.lax.scan``, in float64."""
    import jax

    jax.config.update("jax_enable_x64", True)
    w_in, W_r = jax.numpy.asarray(features.w_in_), jax.numpy.asarray(features.W_r_)
    gamma, x = features.gamma, jax.numpy.zeros(features.r)

    @jax.jit
    def advance(x: jax.Array, theta: jax.Array) -> tuple[jax.Array, jax.Array]:
        x = gamma * x + (1.0 - gamma) * jax.numpy.tanh(w_in @ theta + W_r @ x)
        return x, x

    run = jax.jit(lambda X: jax.lax.scan(advance, jax.numpy.zeros(features.r), X)[1])

    def step(theta: np.ndarray) -> np.ndarray:
        nonlocal x
        x, _ = advance(x, theta)
        return np.asarray(x)

    return lambda X: np.asarray(run(X)), step


def esnfed(features: EchoStates) -> Peer:
    """Return esnfed's network, which has no single step; its leak is 1 - gamma."""
    inputs = features.w_in_.shape[1]
    network = import_module("esnfed").EchoStateNetwork(
        inputs,
        1,
        features.W_r_,
        # it scales W_r to this radius: leave it as it is
        spectral_radius=float(np.abs(np.linalg.eigvals(features.W_r_)).max()),
        leaking_rate=1.0 - features.gamma,
        input_weights=np.hstack([np.zeros((features.r, 1)), features.w_in_]),
    )
    return lambda X: network.harvest(X)[:, 1 + inputs :], None


#: By label in the table: its package, and how to make the peer.
PEERS = {
    "ReservoirPy": ("reservoirpy", reservoirpy),
    "lax.scan in JAX": ("jax", jax_scan),
    "esnfed": ("esnfed", esnfed),
}
