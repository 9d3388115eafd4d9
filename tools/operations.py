"""Print a hash of the result of each operation; equal bits have equal hashes.

diff <(python tools/operations.py) <(OPENBLAS_CORETYPE=Haswell python tools/operations.py)

shows the operations whose bits depend on OpenBLAS's kernel. ``PROCESSORS`` in tools/twice.py has
the variables that restrict other libraries.
"""

import hashlib
import math

import numba
import numpy as np
from scipy import linalg, signal

RANDOM = np.random.default_rng(0)
SQUARE = RANDOM.normal(size=(800, 800))
TALL = RANDOM.normal(size=(4000, 12))
VECTOR = RANDOM.normal(size=800)
POSITIVE = SQUARE + SQUARE.T + 800 * np.eye(800)  # no products: each operation stands alone
LONG = RANDOM.normal(size=100_000)


def over(function):
    """Return a compiled loop of a function over LONG."""

    @numba.njit(error_model="numpy")
    def loop(x):
        out = np.empty_like(x)
        for k in range(x.size):
            out[k] = function(x[k])
        return out

    return lambda: loop(LONG)


def summed(**options):
    """Return a compiled sum of squares."""

    @numba.njit(error_model="numpy", **options)
    def loop(x):
        total = 0.0
        for k in range(x.size):
            total += x[k] * x[k]
        return total

    return lambda: loop(LONG)


OPERATIONS = {
    "BLAS: matrix times vector": lambda: SQUARE @ VECTOR,
    "BLAS: inner product": lambda: VECTOR @ VECTOR,
    "BLAS: matrix times matrix": lambda: SQUARE @ SQUARE.T,
    "BLAS: tall matrix times itself": lambda: TALL.T @ TALL,
    "LAPACK: Cholesky": lambda: linalg.cholesky(POSITIVE),
    "LAPACK: LU": lambda: linalg.solve(SQUARE, VECTOR),
    "LAPACK: eigenvalues": lambda: np.linalg.eigvals(SQUARE),
    "LAPACK: singular values": lambda: np.linalg.svd(TALL, compute_uv=False),
    "NumPy: sum": LONG.sum,
    "NumPy: mean of columns": lambda: TALL.mean(axis=0),
    "NumPy: standard deviation": LONG.std,
    "NumPy: einsum": lambda: np.einsum("ij,ij->j", TALL, TALL),
    "NumPy: square root": lambda: np.sqrt(np.abs(LONG)),
    "NumPy: exp": lambda: np.exp(LONG),
    "NumPy: log": lambda: np.log(np.abs(LONG)),
    "NumPy: power": lambda: np.abs(LONG) ** 1.3,
    "NumPy: tanh": lambda: np.tanh(LONG),
    "NumPy: sin": lambda: np.sin(LONG),
    "NumPy: arctan2": lambda: np.arctan2(LONG, 2.0),
    "NumPy: interpolation": lambda: np.interp(LONG, np.linspace(-3, 3, 50), np.arange(50.0)),
    "NumPy: percentiles": lambda: np.percentile(LONG, [5, 50]),
    "NumPy: Fourier transform": lambda: np.fft.rfft(LONG),
    "NumPy: random numbers": lambda: np.random.default_rng(3).normal(size=1000),
    "SciPy: filter": lambda: signal.lfilter([0.1], [1.0, -0.9], LONG),
    "C library: exp": lambda: [math.exp(x) for x in LONG],
    "C library: sin": lambda: [math.sin(x) for x in LONG],
    "C library: power": lambda: [math.pow(abs(x), 1.3) for x in LONG],
    "compiled: exp": over(math.exp),
    "compiled: tanh": over(math.tanh),
    "compiled: sin": over(math.sin),
    "compiled: sum": summed(),
    "compiled: sum in any order": summed(fastmath={"reassoc", "contract"}),
}

if __name__ == "__main__":
    for name, operation in OPERATIONS.items():
        bits = np.ascontiguousarray(operation()).tobytes()
        print(f"{name:32}  {hashlib.sha256(bits).hexdigest()[:12]}")
