import itertools

import matplotlib.pyplot as plt
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from matplotlib.patches import FancyBboxPatch
from matplotlib.text import Text
from matplotlib.transforms import Bbox

from fprc.figures import soft_bodies as soft
from fprc.figures import style
from fprc.figures.structure import boyle
from fprc.logs import write_columns
from fprc.stages import draw_schematics as draw

pytestmark = pytest.mark.slow

MODELS = {
    "n_y": 5,
    "esn": {"r": 800, "gamma": 0.8, "rho": 0.4, "f_input": 0.02},
    "fprc": {"epsilon": 0.01, "n_u": 3, "n_c": 8},
}
# longer than any number that the grids use
LONG = {
    "n_y": 10,
    "esn": {"r": 10000, "gamma": 0.95, "rho": 0.85, "f_input": 0.001},
    "fprc": {"epsilon": 1e-4, "n_u": 10, "n_c": 16},
}
CONTROL, LONG_CONTROL = {"k_in_kpa_per_deg": 7.0}, {"k_in_kpa_per_deg": 12.5}

TIME = np.linspace(0.0, 2.0 * np.pi, 181)
angles = st.floats(-40.0, 90.0)


def length(points):
    return np.hypot(*np.diff(points, axis=0).T).sum()


@given(angles)
def test_plate_keeps_its_length_at_every_angle(angle_deg):
    along = np.linspace(0.0, 1.0, 2001)
    assert length(soft.bend(along, np.zeros(2001), angle_deg)) == pytest.approx(1.0, abs=1e-6)


@given(angles, st.floats(-0.3, 0.3))
def test_end_is_rotated_by_the_angle_and_the_base_is_not(angle_deg, beside):
    turn = np.radians(angle_deg)
    ends = soft.bend(np.array([-0.1, 0.0, 1.0, 1.1]), np.full(4, beside), angle_deg)
    assert (ends[1] - ends[0]) / 0.1 == pytest.approx((0.0, -1.0))
    assert (ends[3] - ends[2]) / 0.1 == pytest.approx((np.sin(turn), -np.cos(turn)))


@given(st.floats(0.0, 60.0), st.floats(0.5, 1.0))
def test_squeezed_bladder_is_drawn_as_large_as_its_air(angle_deg, share):
    def drawn(angle, width):
        return soft.area(soft.bladder(angle, width, -1, soft.WALL))

    width = soft.squeezed(angle_deg, share)
    assert drawn(angle_deg, width) == pytest.approx(share * drawn(0.0, soft.DIAMETER))


@given(st.floats(0.0, 200.0), st.floats(0.0, 300.0))
def test_sealed_air_keeps_pressure_times_volume(rest_kpa, more_kpa):
    share = boyle((0.0, rest_kpa, 0.0), (400.0, rest_kpa + more_kpa, 30.0))
    assert share * (rest_kpa + more_kpa + 101.3) == pytest.approx(rest_kpa + 101.3)
    assert share <= 1.0


def write_log(path, **channels):
    channels = {
        "p_exp_kpa": 170.0 - 168.0 * np.cos(TIME),
        "theta_deg": 27.0 - 27.4 * np.cos(TIME - 0.3),
        "p_i_kpa": 200.0 - 201.0 * np.cos(TIME),
        "p_o_kpa": 124.0 - 24.0 * np.cos(TIME - 0.2),
        "phi_deg": 20.0 - 20.0 * np.cos(TIME - 0.1),
    } | channels
    write_columns(path, channels, {"source": "sim", "seed": 7})
    return channels


@pytest.fixture(scope="module")
def draw_in(tmp_path_factory):
    """Run a stage, which saves no files; return its figure and what the stage returned."""
    raw, saved, save = str(tmp_path_factory.mktemp("drawn") / "raw.h5"), [], style.save

    def remember(fig, data, *files):
        saved.append(fig)
        return save(fig, data)

    def call(stage, log=None, **settings):
        if log is not None:
            write_log(raw, **log)
            settings["raw"] = raw
        data = stage(pdf="f.pdf", png="f.png", **settings)
        return saved[-1], data

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(style, "save", remember)
        yield call


CALLS = {
    "actuator": (draw.draw_actuator, {"log": {}}),
    "reservoir": (draw.draw_reservoir, {"log": {}, **CONTROL}),
    "apparatus": (draw.draw_apparatus, {}),
    "esn": (draw.draw_esn_system, {"models": MODELS}),
    "fprc": (draw.draw_fprc_system, {"models": MODELS, "control": CONTROL}),
}
LONG_CALLS = {
    "reservoir, long": (
        draw.draw_reservoir,
        {"log": {"p_i_kpa": 230.0 - 201.0 * np.cos(TIME)}, **LONG_CONTROL},
    ),
    "esn, long": (draw.draw_esn_system, {"models": LONG}),
    "fprc, long": (draw.draw_fprc_system, {"models": LONG, "control": LONG_CONTROL}),
}


@pytest.fixture(scope="module")
def drawings(draw_in):
    """Every figure, drawn once."""
    calls = (CALLS | LONG_CALLS).items()
    return {name: draw_in(stage, **settings) for name, (stage, settings) in calls}


@pytest.fixture(scope="module", params=CALLS | LONG_CALLS)
def picture(request, drawings):
    return drawings[request.param][0]


@pytest.fixture(scope="module")
def places(picture):
    """Where each text of the picture is."""
    picture.draw_without_rendering()
    return {text: text.get_window_extent() for text in texts(picture)}


def words(fig):
    return [text.get_text() for text in texts(fig)]


def texts(fig):
    """Every text that is seen; ticks outside the limits are not."""
    found = [text for text in fig.findobj(Text) if text.get_text() and text.get_visible()]
    unseen = {
        label
        for ax in fig.findobj(plt.Axes)
        for axis in (ax.xaxis, ax.yaxis)
        for label, at in zip(axis.get_ticklabels(), axis.get_ticklocs(), strict=True)
        if not ax.axison or not min(axis.get_view_interval()) <= at <= max(axis.get_view_interval())
    }
    return [text for text in found if text not in unseen]


def test_no_two_texts_overlap_and_none_is_clipped(picture, places):
    assert len(places) > 5
    for (one, first), (other, second) in itertools.combinations(places.items(), 2):
        assert not first.overlaps(second), (one.get_text(), other.get_text())
    for text, box in places.items():
        assert encloses(picture.bbox, box), text.get_text()
        assert text.get_fontsize() >= (5.5 if text is picture._supxlabel else 6.0)


def test_text_stays_in_its_box(picture, places):
    boxes = [patch.get_window_extent() for patch in picture.findobj(FancyBboxPatch)]
    for text, place in places.items():
        for box in boxes:
            assert encloses(box, place) or not box.overlaps(place), text.get_text()


def encloses(outer, inner):
    return Bbox.union([outer, inner]).bounds == pytest.approx(outer.bounds)


def test_reservoir_shows_the_numbers_and_the_loop_of_its_log(drawings, tmp_path):
    fig, data = drawings["reservoir"]
    log = write_log(tmp_path / "raw.h5")
    p_i, p_o, phi = (log[name] for name in ("p_i_kpa", "p_o_kpa", "phi_deg"))
    rest, driven = np.argmin(p_i), np.argmax(phi)
    shown = words(fig)
    assert f"A: atmospheric\nB: $P_o$ = {p_o[rest]:.0f} kPa" in shown
    assert f"A: $P_i$ = {p_i[driven]:.0f} kPa\nB: $P_o$ = {p_o[driven]:.0f} kPa" in shown
    assert rf"$\phi$ = {phi[driven]:.0f}°" in shown
    assert "7 kPa/deg" in shown
    loop = fig.axes[0].child_axes[0].lines[0]
    assert loop.get_xdata().tolist() == p_i.tolist()
    assert loop.get_ydata().tolist() == p_o.tolist()
    assert data["source"] == "sim"


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("esn, long", ("= 10000", "$n_y$ = 10", r"$\gamma$ = 0.95", r"$\rho$ = 0.85", "= 0.001")),
        ("fprc, long", ("12.5 kPa/deg", "$n_y$ = 10", "$n_u$ = 10", "$n_c$ = 16", "= 0.0001")),
        # at the largest angle, and where the pressure is lowest after it
        ("actuator", ("= 330 kPa", "= 54°", "= 2 kPa", "= 1°")),
        ("reservoir, long", ("A: $P_i$ = 29 kPa", "12.5 kPa/deg")),
    ],
)
def test_drawing_shows_its_settings(drawings, name, expected):
    shown = " ".join(words(drawings[name][0]))
    for text in expected:
        assert text in shown
