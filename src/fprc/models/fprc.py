"""Fuzzy pneumatic reservoir computing, and the fuzzy model without a reservoir."""

from dataclasses import dataclass

from fprc.limits import MODEL
from fprc.models.features import TapFeatures
from fprc.models.sequence import SequenceModel
from fprc.models.takagi_sugeno import TakagiSugenoReadout


@dataclass(eq=False, repr=False)
class FPRC(SequenceModel):
    """Takagi-Sugeno fuzzy readout over a pneumatic reservoir.

    x(k) = [theta(k), ..., theta(k-n_y+1), P~_o(k), ..., P~_o(k-n_u+1)]
    P_ff(k) = beta_bar(k) W_out [1, x(k)]        (12, with the leading 1)

    ``X`` has two columns, theta_d in deg and P_o in kPa; further columns are further readouts of
    the reservoir. Its rows are samples in time: see ``SequenceModel`` for cross-validation.

    Parameters
    ----------
    epsilon : float, default=0.01
        Filter factor of the readouts, in [1e-9, 1].
    n_c : int, default=8
        Fuzzy rules, >= 1.
    n_u : int, default=3
        Taps of the filtered readouts.
    n_y : int, default=5
        Taps of theta_d.
    sigma : float, default=2.0
        Gaussian membership scaling, in the unit of the features.
    alpha : float, default=1e-3
        Ridge parameter of every rule, >= 0.
    random_state : int or None, default=None
        Start of the clustering.
    restarts : int, default=1
        Starts of the clustering, >= 1; the one with the lowest objective is kept.

    Attributes
    ----------
    features_ : TapFeatures
    readout_ : TakagiSugenoReadout

    References
    ----------
    Paper, Sec. III-B, Eqs. (6)-(12).
    """

    epsilon: float = MODEL["epsilon"].default
    n_c: int = MODEL["n_c"].default
    n_u: int = MODEL["n_u"].default
    n_y: int = MODEL["n_y"].default
    sigma: float = MODEL["sigma"].default
    alpha: float = MODEL["alpha"].default
    random_state: int | None = None
    restarts: int = MODEL["restarts"].default

    def make_features(self) -> TapFeatures:
        return self._part(TapFeatures)

    def make_readout(self) -> TakagiSugenoReadout:
        return self._part(TakagiSugenoReadout)


@dataclass(eq=False, repr=False)
class FuzzyLinear(SequenceModel):
    """Takagi-Sugeno fuzzy model of theta_d alone, the paper's comparison.

    x(k) = [theta(k), ..., theta(k-n_y+1)]
    P_ff(k) = beta_bar(k) W_out [1, x(k)]

    The paper replaces [1, x] by [1, theta] in Eqs. (7) and (12), but does not
    say whether the clusters still use P_o. Here they do not, so that the model
    needs no reservoir. ``X`` has one column; of a second, P_o too, it takes taps as of another
    reference, and is not the paper's model any more. The rows of ``X`` are samples in time, see
    ``SequenceModel``. Parameters and attributes are those of ``FPRC``.

    Parameters
    ----------
    n_c : int, default=8
    n_y : int, default=5
    sigma : float, default=2.0
    alpha : float, default=1e-3
    random_state : int or None, default=None
    restarts : int, default=1

    References
    ----------
    Paper, Sec. III-D.
    """

    n_c: int = MODEL["n_c"].default
    n_y: int = MODEL["n_y"].default
    sigma: float = MODEL["sigma"].default
    alpha: float = MODEL["alpha"].default
    random_state: int | None = None
    restarts: int = MODEL["restarts"].default

    def make_features(self) -> TapFeatures:
        return self._part(TapFeatures, n_references=None, n_u=1)

    def make_readout(self) -> TakagiSugenoReadout:
        return self._part(TakagiSugenoReadout)
