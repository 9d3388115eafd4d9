"""Echo state network feedforward model."""

from dataclasses import dataclass

from fprc.limits import MODEL
from fprc.models.echo import EchoStates
from fprc.models.ridge import RidgeReadout
from fprc.models.sequence import SequenceModel


@dataclass(eq=False, repr=False)
class ESN(SequenceModel):
    """Echo state network with a ridge readout.

    x(k+1) = gamma x(k) + (1 - gamma) tanh(w_in theta(k) + W_r x(k))     (3)
    P_ff(k) = w_out [1, theta(k), ..., theta(k-n_y+1), x(k)]             (4)

    ``X`` has one column, theta_d in deg; further columns are further inputs. Its rows are samples
    in time, see ``SequenceModel``.

    Parameters
    ----------
    r : int, default=800
        Reservoir size, at most 4,000: W_r then takes 128 MB.
    f_input : float, default=0.02
        Input scaling factor, on N(0, 1) weights.
    gamma : float, default=0.8
        Leaky rate, in [0, 0.999999].
    rho : float, default=0.4
        Spectral radius: largest absolute eigenvalue of W_r before its rounding to float32.
    n_y : int, default=5
        Taps of every input, >= 1.
    alpha : float, default=1e-3
        Ridge parameter; penalises the bias too.
    washout : int, default=100
        Steps with the first sample as constant input, in which x settles before the log begins.
    random_state : int or None, default=None
        Source of the random w_in and W_r.

    Attributes
    ----------
    features_ : EchoStates
    readout_ : RidgeReadout

    References
    ----------
    Paper, Sec. III-A, Eqs. (3)-(5); Jaeger 2002.
    """

    r: int = MODEL["r"].default
    f_input: float = MODEL["f_input"].default
    gamma: float = MODEL["gamma"].default
    rho: float = MODEL["rho"].default
    n_y: int = MODEL["n_y"].default
    alpha: float = MODEL["alpha"].default
    washout: int = MODEL["washout"].default
    random_state: int | None = None

    def make_features(self) -> EchoStates:
        return self._part(EchoStates)

    def make_readout(self) -> RidgeReadout:
        return self._part(RidgeReadout)
