"""The equation numbers in docstrings are those of the paper."""

import ast
import re
from pathlib import Path

import fprc

SOURCES = Path(fprc.__path__[0])

#: The paper's numbering, by what an equation defines.
PAPER = {
    1: "P_i", 2: "F_r", 3: "x(k+1)", 4: "P_ff of the ESN", 5: "ridge of the ESN", 6: "low-pass",
    7: "P_ff of a rule", 8: "ridge of a rule", 9: "W_out", 10: "beta", 11: "beta_bar",
    12: "output", 13: "min-max", 14: "weight shares",
}  # fmt: skip

#: What each docstring that names an equation is about.
NAMED = {
    "control.loop.hysteresis_law": {"P_i"},
    "experiments.grids.normalised": {"min-max"},
    "experiments.grids.weight_shares": {"min-max", "weight shares"},
    "studies.calibration.surrogate._Thinned.p_o_over_theta_d": {"min-max", "weight shares"},
    "models.echo.echo_states": {"x(k+1)"},
    "models.echo.update": {"x(k+1)"},
    "models.esn.ESN": {"x(k+1)", "P_ff of the ESN", "ridge of the ESN"},
    "models.echo_features.EchoStates": {"x(k+1)"},
    "models.features.TapFeatures": {"low-pass"},
    "models.features.lowpass": {"low-pass"},
    "models.kernels.advance": {"low-pass"},
    "models.features.LowpassBank": {"low-pass"},
    "models.fprc.FPRC": {PAPER[number] for number in range(6, 13)},
    "models.fprc.FuzzyLinear": {"P_ff of a rule", "output"},
    "models.kernels.blend": {"beta", "beta_bar", "output"},
    "models.takagi_sugeno.gaussian_memberships": {"beta", "beta_bar"},
    "models.c_header.c_header": {PAPER[number] for number in (4, 6, 10, 11, 12)},
    "models.ridge_readout.RidgeReadout": {"P_ff of the ESN", "ridge of the ESN"},
    "models.ridge.with_bias": {"P_ff of the ESN", "P_ff of a rule"},
    "models.takagi_sugeno.TakagiSugenoReadout": {PAPER[number] for number in range(7, 13)},
    "models.takagi_sugeno.TakagiSugenoReadout.fit": {"ridge of a rule"},
}

_CITED = re.compile(r"Eqs?\. ((?:\(?\d+\)?(?:-|, | and )?)+)")
_TAGGED = re.compile(r" {4,}\((\d+)(?:, with the leading 1)?\)$", re.MULTILINE)


def docstrings():
    """Yield the dotted name and the docstring of every definition."""
    for path in SOURCES.rglob("*.py"):
        module = ".".join(path.relative_to(SOURCES).with_suffix("").parts)
        todo = [(module, ast.parse(path.read_text(encoding="utf-8")))]
        while todo:
            name, node = todo.pop()
            yield name, ast.get_docstring(node) or ""
            todo += [
                (f"{name}.{child.name}", child)
                for child in node.body
                if isinstance(child, ast.FunctionDef | ast.ClassDef)
            ]


def numbers(text):
    """Return the numbers of the equations that a docstring names."""
    found = {int(number) for number in _TAGGED.findall(text)}
    for cited in _CITED.findall(text):
        for first, last in re.findall(r"(\d+)\)?(?:-\(?(\d+))?", cited):
            found |= set(range(int(first), int(last or first) + 1))
    return found


def test_docstrings_name_the_equations_that_they_are_about():
    found = {
        name: {PAPER[number] for number in numbers(text)}
        for name, text in docstrings()
        if numbers(text)
    }
    assert found == NAMED
