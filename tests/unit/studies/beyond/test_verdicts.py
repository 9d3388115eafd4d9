"""Tables of verdicts in families whose numbers are known."""

from fprc.studies.beyond.claims import CLAIMS
from fprc.studies.beyond.verdicts import claims_page, details_page, fitted_page


def test_mark_beside_a_verdict_says_whom_the_fit_favours(verdicts):
    page = claims_page(verdicts).set_index("Id")
    mean = verdicts[verdicts["id"] == "B1"]["mean"].iloc[0]
    assert page.loc["B1", "dry"] == f"superior†‡ {mean:.3f}"
    assert page.loc["B4", "dry"].startswith("superior† ")
    assert page.loc["B7", "sparse"].startswith("undecided† ")
    assert not page["drawn"].str.contains("[†‡]").any()
    # fitted as well, but there is no verdict
    assert page.loc["B1", "broken"] == "not judged"


def test_details_say_on_what_a_verdict_rests(verdicts):
    page = details_page(verdicts).set_index(["Id", "Rigs"])
    assert list(page.index[:3]) == [("B1", "dry"), ("B1", "drawn"), ("B4", "dry")]
    part = verdicts[verdicts["id"] == "B1"].iloc[0]
    assert page.loc[("B1", "dry")].tolist() == [
        "superior†‡", f"{part['mean']:.3f}", f"{part['low']:.3f} to {part['high']:.3f}",
        "< 0.001", "100 %", "12", "0",
    ]  # fmt: skip
    assert page.loc[("B7", "sparse"), ["Units", "Subsets that agree"]].tolist() == ["3", "-"]
    # not judged, so there is nothing to show
    assert "broken" not in page.index.get_level_values("Rigs")


def test_tidy_claims_have_a_row_for_each_part(verdicts):
    assert verdicts.groupby(["world", "id"]).size()["dry"].to_dict() == {
        "W1": 1, "W2": 2, "W3": 2, "W4": 1, "B1": 1, "B4": 1, "B7": 3, "B8": 2,
    }  # fmt: skip
    broken = verdicts[verdicts["world"] == "broken"]
    assert broken["id"].tolist() == [*CLAIMS]
    assert (broken["verdict"] == "not judged").all()
    decided = verdicts[verdicts["verdict"].isin(["superior", "equivalent", "inferior"])]
    assert len(decided) > 6
    assert not decided.isna().any().any()


def test_what_was_fitted_names_its_claims_and_families(verdicts):
    page = fitted_page(verdicts).set_index("What was fitted")
    assert page.loc["FPRC's forward error, at epsilon 0.01"].tolist() == [
        "FPRC †",
        "B1, B4, W4",
        "dry",
    ]
    assert page.loc["P_o's share of the readout's weights"].tolist() == [
        "P_o ‡", "B1, B8, W1, W2, W3", "dry",
    ]  # fmt: skip
    lowest = page.loc["FPRC's error as the lowest of the paper's models"]
    assert lowest[["Claims", "Rigs"]].to_numpy().tolist() == [
        ["B1, B4, W4", "dry"], ["B7", "dry, sparse"],
    ]  # fmt: skip
    assert fitted_page(verdicts[verdicts["world"] == "drawn"]).empty
