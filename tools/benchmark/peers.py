"""The same computations with other libraries."""

from collections.abc import Callable
from importlib import import_module
from typing import NamedTuple

import numpy as np

from fprc.models import EchoStates


class Peer(NamedTuple):
    """The network of an ESN in another library, with the same weights, from state 0."""

    states: Callable[[np.ndarray], np.ndarray]  #: x(k+1) for each sample k of a log
    step: Callable[[np.ndarray], np.ndarray] | None  #: x after one more sample, if it can


def reservoirpy(features: EchoStates, package: str = "reservoirpy") -> Peer:
    """Return ReservoirPy's network of one of its two backends; its leak is 1 - gamma."""
    network = import_module(f"{package}.nodes").Reservoir(
        W=features.W_r_, Win=features.w_in_, bias=np.zeros(features.r), lr=1.0 - features.gamma
    )
    network.initialize(np.zeros((1, features.w_in_.shape[1])))

    def states(X: np.ndarray) -> np.ndarray:
        network.reset()
        return np.asarray(network.run(X))

    return Peer(states, lambda theta: np.asarray(network.step(theta)))


def reservoirpy_jax(features: EchoStates) -> Peer:
    """Return ReservoirPy's network in JAX, in float64."""
    import_module("jax").config.update("jax_enable_x64", True)
    return reservoirpy(features, "reservoirpy.jax")


def jax_scan(features: EchoStates) -> Peer:
    """Return Eq. (3) under ``jax.lax.scan``, in float64."""
    import jax

    jax.config.update("jax_enable_x64", True)
    w_in, W_r, gamma = (
        jax.numpy.asarray(features.w_in_),
        jax.numpy.asarray(features.W_r_),
        features.gamma,
    )
    x = jax.numpy.zeros(features.r)

    @jax.jit
    def advance(x: jax.Array, theta: jax.Array) -> tuple[jax.Array, jax.Array]:
        x = gamma * x + (1.0 - gamma) * jax.numpy.tanh(w_in @ theta + W_r @ x)
        return x, x

    run = jax.jit(lambda X: jax.lax.scan(advance, jax.numpy.zeros(features.r), X)[1])

    def step(theta: np.ndarray) -> np.ndarray:
        nonlocal x
        x, _ = advance(x, theta)
        return np.asarray(x)

    return Peer(lambda X: np.asarray(run(X)), step)


def esnfed(features: EchoStates) -> Peer:
    """Return esnfed's network, which has no single step; its leak is 1 - gamma."""
    from esnfed import EchoStateNetwork

    inputs = features.w_in_.shape[1]
    network = EchoStateNetwork(
        inputs,
        1,
        features.W_r_,
        # it scales W_r to this radius: leave it as it is
        spectral_radius=float(np.abs(np.linalg.eigvals(features.W_r_)).max()),
        leaking_rate=1.0 - features.gamma,
        input_weights=np.hstack([np.zeros((features.r, 1)), features.w_in_]),
    )
    return Peer(lambda X: network.harvest(X)[:, 1 + inputs :], None)


def limit(features: EchoStates) -> Peer:
    """Return W_r x by BLAS, which is most of the work: of a thousand samples at once, or of one.

    The first is limited by multiplications, the second, in float32, by reading W_r.
    """
    W_r, rows = features.W_r_, np.ones((1000, features.r))
    narrow, x = W_r.astype(np.float32), np.ones(features.r, np.float32)

    def states(X: np.ndarray) -> np.ndarray:
        for _ in range(len(X) // len(rows)):
            rows @ W_r
        return rows

    return Peer(states, lambda theta: narrow @ x)


#: By label in the table: its package, and how to make the peer.
PEERS = {
    "ReservoirPy": ("reservoirpy", reservoirpy),
    "ReservoirPy in JAX": ("reservoirpy", reservoirpy_jax),
    "lax.scan in JAX": ("jax", jax_scan),
    "esnfed": ("esnfed", esnfed),
}
