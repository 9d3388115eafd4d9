import ctypes
import re
import shutil
import subprocess
from copy import deepcopy
from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose
from sklearn.base import clone
from sklearn.linear_model import Ridge

from fprc.errors import FprcError
from fprc.limits import LARGEST
from fprc.models import (
    FPRC,
    NVAR,
    EchoStates,
    FeatureModel,
    FuzzyLinear,
    Learning,
    LowpassBank,
    Online,
    PlayOperators,
    RidgeReadout,
    SideBySide,
    TakagiSugenoReadout,
    TapFeatures,
)
from fprc.models.c_header import c_header

pytestmark = pytest.mark.slow

STRICT = (
    "-Wall", "-Wextra", "-Werror", "-pedantic", "-Wconversion", "-Wdouble-promotion", "-Wshadow",
    "-O2", "-fPIC", "-shared",
)  # fmt: skip
C99 = ("cc", "-std=c99", *STRICT)
FREESTANDING = (*C99, "-ffreestanding")
CPP = ("c++", "-x", "c++", "-std=c++11", *STRICT)
#: The numbers are those of double, which the compiler rounds.
FLOAT = ("-DPFF_FLOAT", "-Wno-float-conversion")

#: What lets ctypes call the header's functions, which are static.
WRAPPER = """
#include "pff.h"
#ifdef __cplusplus
extern "C" {
#endif
unsigned size(void) { return sizeof(pff_state); }
void begin(pff_state *s) { pff_init(s); }
void restart(pff_state *s, const pff_real *x) { pff_reset(s, x); }
pff_real next(pff_state *s, const pff_real *x) { return pff_step(s, x); }
#ifdef LEARNS
void learn(pff_state *s, pff_real error, pff_real theta) { pff_learn(s, error, theta); }
void sent(pff_state *s, pff_real p_fb) { pff_sent(s, p_fb); }
#endif
#ifdef __cplusplus
}
#endif
"""

MAPS = [
    (TapFeatures(n_y=3, n_u=2, epsilon=0.2), [2, 0]),
    (PlayOperators(n_plays=4), [1, 0]),
    (SideBySide([(LowpassBank((1.0, 0.05)), [1])]), [0, 2]),
]
MODELS = {
    "fprc": FPRC(random_state=1),
    "two_readouts": FPRC(n_c=3, n_u=7, n_y=2, epsilon=0.3, sigma=0.7, random_state=1),
    "fuzzy_linear": FuzzyLinear(random_state=1),
    "ridge": FeatureModel(SideBySide(MAPS), RidgeReadout()),
    "fuzzy": FeatureModel(SideBySide(MAPS), TakagiSugenoReadout(n_c=3), random_state=1),
    "one_play": FeatureModel(PlayOperators(n_plays=1), RidgeReadout()),
}
COLUMNS = {"fuzzy_linear": 1, "two_readouts": 3, "ridge": 3, "fuzzy": 3}


@pytest.fixture(scope="module")
def fitted():
    trained = {}
    for name, model in MODELS.items():
        X = recording(600, columns(name))
        trained[name] = clone(model).fit(X, X[:, 0] ** 2 / 20.0 + X.sum(axis=1))
    return trained


@pytest.fixture(scope="module")
def compiled(fitted, tmp_path_factory):
    """A function that compiles a model, once, and returns a new stream of it."""

    @cache
    def build(name, command, *options):
        return library_of(c_header(fitted[name], "pff"), command, tmp_path_factory, *options)

    return lambda name, command=C99, *options: Stream(
        build(name, command, *options), np.float32 if options else np.float64
    )


def library_of(header, command, tmp_path_factory, *options):
    """Compile a header and return the library."""
    if shutil.which(command[0]) is None:
        pytest.skip(f"no compiler, {command[0]}")
    folder = tmp_path_factory.mktemp("c")
    (folder / "pff.h").write_text(header)
    (folder / "wrapper.c").write_text(WRAPPER)
    made = [*command, *options, "wrapper.c", "-o", "pff.so", "-lm"]
    subprocess.run(made, cwd=folder, check=True)
    return folder / "pff.so"


class Stream:
    def __init__(self, path, dtype):
        self.path, self.dtype = path, dtype
        self._library = ctypes.CDLL(str(path))
        self._library.next.restype = np.ctypeslib.as_ctypes_type(dtype)
        # init must overwrite what the memory held
        self._state = ctypes.create_string_buffer(b"\xaa" * self._library.size())
        self.reset()

    def reset(self, x=None):
        if x is None:
            self._library.begin(self._state)
        else:
            self._call(self._library.restart, x)

    def step(self, x):
        return self._call(self._library.next, x)

    def learn(self, error, theta):
        self._library.learn(self._state, ctypes.c_double(error), ctypes.c_double(theta))

    def sent(self, p_fb):
        self._library.sent(self._state, ctypes.c_double(p_fb))

    def _call(self, function, x):
        x = np.ascontiguousarray(x, self.dtype)
        return function(self._state, ctypes.c_void_p(x.ctypes.data))


@pytest.mark.parametrize(
    ("name", "command"),
    [(name, C99) for name in MODELS]
    + [(name, command) for name in ("fprc", "fuzzy_linear") for command in (FREESTANDING, CPP)],
)
def test_compiled_header_steps_as_the_model_does(name, command, fitted, compiled):
    X = recording(500, columns(name), seed=2)
    assert_allclose(steps(compiled(name, command), X), steps(fitted[name], X), rtol=0, atol=1e-9)


@pytest.mark.parametrize("command", [C99, CPP], ids=["c99", "c++"])
def test_float_agrees_to_the_digits_of_float(command, fitted, compiled):
    X = recording(500, 2, seed=2)
    exact, got = steps(fitted["fprc"], X), steps(compiled("fprc", command, *FLOAT), X)
    assert 0.0 < np.abs(got - exact).max() < 0.05


def test_any_samples_and_resets_give_the_same_stream_and_the_same_refusals(fitted, compiled):
    values = st.sampled_from([np.nan, np.inf, -np.inf, 1e300, -1e300, 1e9, -1e9, 5e-324, 0.0])
    edges = st.sampled_from([np.nextafter(1e9, 2e9), np.nextafter(-1e9, -2e9)])
    sample = arrays(np.float64, 3, elements=values | edges | st.floats(-300.0, 300.0))
    calls_ = st.tuples(st.sampled_from(["step"] * 4 + ["reset", "init"]), sample)

    @given(st.sampled_from(sorted(fitted)), st.lists(calls_, max_size=30))
    def same(name, calls):
        c, python = compiled(name), fitted[name]
        python.reset()
        scale = 1.0
        for call, x in calls:
            x = x[: columns(name)]
            is_fault = not np.all(np.abs(x) <= 1e9)
            scale = max(scale, 0.0 if is_fault else np.abs(x).max())
            if call == "step":
                found = c.step(x)
                if is_fault:
                    assert np.isnan(found)
                    with pytest.raises(ValueError, match="is ignored"):
                        python.step(x)
                else:
                    assert_allclose(found, python.step(x), rtol=1e-6, atol=1e-6 * scale)
            else:
                # a reset to a fault begins at the next sample
                c.reset(x if call == "reset" else None)
                python.reset(None if is_fault or call == "init" else x)

    same()


def test_compiled_header_calls_nothing_but_exp(compiled):
    if shutil.which("nm") is None:
        pytest.skip("no nm")
    stream = compiled("fprc", (*FREESTANDING, "-nostdlib"))
    listed = subprocess.run(
        ["nm", "-D", "-u", stream.path], capture_output=True, text=True, check=True
    ).stdout
    called = {re.split(r"[\s@]+", line.strip())[1] for line in listed.splitlines()}
    # a compiler may replace a loop by one of the first three; C requires every system to have them
    assert called - {"memmove", "memcpy", "memset"} == {"exp"}


def test_two_models_fit_into_one_program(fitted, tmp_path):
    if shutil.which("cc") is None:
        pytest.skip("no C compiler, cc")
    (tmp_path / "a.h").write_text(c_header(fitted["fprc"], "a"))
    (tmp_path / "b.h").write_text(c_header(fitted["fuzzy_linear"], "b"))
    program = tmp_path / "both.c"
    program.write_text('#include "a.h"\n#include "b.h"\n#include "a.h"\na_state s; b_state t;\n')
    flags = (flag for flag in C99 if flag != "-shared")
    command = [*flags, "-DB_FLOAT", FLOAT[1], "-c", program, "-o", tmp_path / "o"]
    subprocess.run(command, check=True)


def test_comment_has_rate_units_and_columns_of_the_training_and_cannot_be_ended():
    X = recording(100, 2)
    model = FPRC(n_c=2, random_state=1).fit(X, X[:, 0])
    model.sample_rate_hz_, model.units_ = 1.0 / 0.01, np.array(["bar", "rad", "*/"], dtype=object)
    model.feature_names_in_ = np.array(["theta", "P_o */ int x; /*"], dtype=object)
    comment = c_header(model, "pff", origin="a\n*/ b").partition("#ifndef")[0]
    for line in ("at 100 Hz:", "x[0]: theta_d, rad (column theta)", "x[1]: P_o, __", "P_ff, bar"):
        assert line in comment
    assert comment.count("*/") == 1


class Halved(TapFeatures):
    """A map from outside the package, of which the header knows nothing."""

    def map_recording(self, X):
        return super().map_recording(X) / 2.0

    def map_sample(self, x):
        return super().map_sample(x) / 2.0


@pytest.mark.parametrize(
    ("features", "readout"),
    [
        (EchoStates(r=50, random_state=1), RidgeReadout()),
        (SideBySide([(NVAR(n_taps=2, spacing=3), [0])]), RidgeReadout()),
        (Halved(), RidgeReadout()),
        (SideBySide([(Halved(), [0, 1])]), RidgeReadout()),
        (TapFeatures(), Ridge()),
    ],
)
def test_other_maps_and_readouts_are_refused(features, readout):
    X = recording(100, 2)
    with pytest.raises(FprcError, match="export"):
        c_header(FeatureModel(features, readout).fit(X, X[:, 0]), "pff")


@pytest.mark.parametrize("name", ["", "2x", "a-b", "_a", "ä"])
def test_name_that_is_none_in_c_is_refused(name, fitted):
    with pytest.raises(FprcError, match="cannot begin names in C"):
        c_header(fitted["fprc"], name)


@pytest.mark.parametrize("name", ["fprc", "fuzzy_linear", "ridge"])
@pytest.mark.parametrize("command", [C99, CPP])
def test_header_learns_as_the_model_does(fitted, tmp_path_factory, name, command):
    X = recording(600, columns(name))
    model = deepcopy(fitted[name]).remember(X)
    learning = Learning(prior_s=1.0, memory_s=5.0, limit_kpa=20.0)
    online = Online(model, learning, 0.005, 5000.0)
    header = c_header(model, "pff", online=online)
    c = Stream(library_of(header, command, tmp_path_factory, "-DLEARNS"), np.float64)
    rng, learned = np.random.default_rng(1), []
    for k, x in enumerate(X):
        error = 3.0 * np.sin(0.02 * k) if k % 50 else rng.choice([np.nan, np.inf, -1e10])
        theta = 30.0 * (k % 7 > 0) if k % 40 else rng.choice([np.inf, np.nan, 1e8, 34.0, 70.0])
        p_fb = float(rng.choice([0.0, 5.0, 1e4, np.nan], p=(0.4, 0.4, 0.1, 0.1)))
        for stream in (online, c):
            if k == 400:
                stream.reset(x)
            stream.learn(error, theta)
        assert c.step(x) == pytest.approx(online.step(x), rel=2e-5, abs=1e-3)
        for stream in (online, c):
            stream.sent(p_fb)
        learned.append(abs(online.p_learned_kpa))
    assert 1.0 < max(learned) <= 20.0


def test_header_learns_in_double_only(fitted, tmp_path_factory):
    X = recording(600, 2)
    online = Online(deepcopy(fitted["fprc"]).remember(X), Learning(), 0.005)
    header = c_header(fitted["fprc"], "pff", online=online)
    with pytest.raises(subprocess.CalledProcessError):
        library_of(header, C99, tmp_path_factory, *FLOAT, "-DLEARNS")


@pytest.mark.parametrize("weight", [1e-30, 10.0, 1e20])
@pytest.mark.parametrize("center", [0.0, -1e3, 1e6, LARGEST])
def test_header_equals_step_for_all_centres_that_a_file_may_hold(
    fitted, tmp_path_factory, center, weight
):
    model = deepcopy(fitted["fprc"])
    model.readout_.centers_[:] = center * np.linspace(-1.0, 1.0, 8)
    model.readout_.W_out_[:] = weight * np.linspace(0.5, 1.5, 9)
    c = Stream(library_of(c_header(model, "pff"), C99, tmp_path_factory), np.float64)
    X = recording(50, 2)
    np.testing.assert_allclose(steps(c, X), steps(model, X), rtol=1e-6)


@pytest.mark.parametrize("option", ["-ffast-math", "-Ofast", "-ffinite-math-only"])
def test_compiler_that_may_ignore_nan_is_refused(fitted, tmp_path_factory, option):
    with pytest.raises(subprocess.CalledProcessError):
        library_of(c_header(fitted["fprc"], "pff"), C99, tmp_path_factory, option)


def columns(name):
    return COLUMNS.get(name, 2)


def recording(samples, columns, seed=1):
    rng = np.random.default_rng(seed)
    time = np.arange(samples)[:, None] / 50.0
    waves = 30.0 * np.sin(time * rng.uniform(0.5, 3.0, columns)) + [[25.0, 110.0, 90.0][:columns]]
    return waves + rng.normal(0.0, 0.1, waves.shape)


def steps(stream, X):
    stream.reset()
    return np.array([stream.step(x) for x in X])
