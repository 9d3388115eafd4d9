import re

import matplotlib.pyplot as plt
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.cbook import is_math_text

from fprc import escape

TEXTS = st.text(max_size=30) | st.text("$\\_^{}|`<>*&[]=+-@'\"\x1b\n\t1e.,", max_size=30)


@given(st.text(st.characters(codec=None)))
def test_any_text_becomes_one_printable_line_that_can_be_encoded(text):
    assert escape.visible(text).isprintable()
    escape.visible(text).encode("utf-8")


@given(text=TEXTS)
def test_figure_shows_text_and_no_formula(text):
    shown = escape.figure(text)
    assert not is_math_text(shown)
    fig = plt.figure()
    try:
        assert fig.text(0, 0, "")._preprocess_math(shown) == (escape.visible(text), False)
    finally:
        plt.close(fig)


@given(text=TEXTS)
def test_markdown_comes_back_and_stays_in_its_cell(text):
    shown = escape.markdown(text)
    assert "\n" not in shown
    assert not re.search(r"(?<!\\)(\\\\)*[|<`*]", shown)
    assert re.sub(r"\\([\\`*<>|&$])", r"\1", shown) == escape.visible(text)


TYPESET = [
    ("gamma, f_input, alphabet", "γ, f<sub>input</sub>, alphabet"),
    ("P_o and theta_d, P_ff(k)", "P<sub>o</sub> and θ<sub>d</sub>, P<sub>ff</sub>(k)"),
    ("θ_d/P_o, n_c 16, epsilon", "θ<sub>d</sub>/P<sub>o</sub>, n<sub>c</sub> 16, ε"),
    ("| P_o's | theta |", "| P<sub>o</sub>'s | θ |"),
    ("P_other, theta_deg, p_o_kpa, P_o_x", "P_other, theta_deg, p_o_kpa, P_o_x"),
    ("## How P_o helps\n", "## How P_o helps\n"),
    ("`P_o` and ``a ` P_o``", "`P_o` and ``a ` P_o``"),
    ("```\nP_o\n```\nP_o", "```\nP_o\n```\nP<sub>o</sub>"),
    ("    P_o = 1\nP_o", "    P_o = 1\nP<sub>o</sub>"),
    ('<img alt="P_o"> [P_o](#the-P_o)', '<img alt="P_o"> [P<sub>o</sub>](#the-P_o)'),
]


@pytest.mark.parametrize(("text", "set_low"), TYPESET)
def test_symbols_in_prose_have_low_indices_and_code_is_untouched(text, set_low):
    assert escape.typeset(text) == set_low
    assert escape.typeset(set_low) == set_low


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("FPRC on low-passed theta_d", r"FPRC on low-passed $\theta_d$"),
        (
            "P_ff over P_fb's n_c, epsilon",
            r"$P_\mathrm{ff}$ over $P_\mathrm{fb}$'s $n_c$, $\epsilon$",
        ),
        (r"fuzzy\_linear, P\_o and theta\_deg", r"fuzzy\_linear, $P_o$ and theta\_deg"),
    ],
)
def test_symbols_are_formulas_of_tex(text, shown):
    assert escape.typeset(text, tex=True) == shown
