"""Every row of Table 2 and every figure: its numbers hold their bounds, its picture is as it was.

``python tests/test_demos.py`` draws the gallery anew and stores what its pictures look like: the
signs of their low frequencies, after C. Zauner, "Implementation and benchmarking of perceptual
image hash functions", 2010.
"""

import ast
import json
import math
import tempfile
from pathlib import Path

import numpy as np
import pytest
from matplotlib import rc_context
from PIL import Image
from scipy.fft import dctn

from tpsim import gallery
from tpsim.paths import DEMOS

TABLE_2 = [
    "demo_affineTransform01",
    "demo_DMP_GMR01",
    "demo_DMP_GMR02",
    "demo_DMP_GMR03",
    "demo_DMP_GMR04",
    "demo_DMP_GMR_LQR01",
    "demo_DTW01",
    "demo_GMM01",
    "demo_GMM_HDDC01",
    "demo_GMM_MFA01",
    "demo_GMM_MPPCA01",
    "demo_GMR01",
    "demo_GPR01",
    "demo_IK01",
    "demo_IK02",
    "demo_IK_expForm01",
    "demo_IK_nullspace_TPGMM01",
    "demo_IK_pointing_TPGMM01",
    "demo_OC_LQT01",
    "demo_OC_LQT02",
    "demo_OC_LQT_infHor01",
    "demo_OC_LQT_infHor02",
    "demo_OC_LQT_infHor03",
    "demo_OC_LQT_infHor04",
    "demo_OC_LQT_recursive01",
    "demo_OC_LQT_recursive02",
    "demo_OC_LQT_recursive03",
    "demo_spring01",
    "demo_stdPGMM01",
    "demo_TPGMM01",
    "demo_TPGMR01",
    "demo_TPGP01",
    "demo_TPLQT01",
    "demo_TPproMP01",
    "demo_TPtrajDistrib01",
    "demo_TPtrajGMM01",
    "demo_trajGMM01",
    "demo_trajHSMM01",
    "benchmark_DS_GP_GMM01",
    "benchmark_DS_GP_raw01",
    "benchmark_DS_PGMM01",
    "benchmark_DS_TP_GMM01",
    "benchmark_DS_TP_GP01",
    "benchmark_DS_TP_LWR01",
    "benchmark_DS_TP_MFA01",
    "benchmark_DS_TP_trajGMM01",
]
NAMED_IN_THE_TEXT = ["demo_TPHDDC01", "demo_TPMFA01", "demo_TPMPPCA01"]
FURTHER_WORK = ["demo_eigenframes01"]
FIGURES = ["figure03", "figure04", "figure05", "figure06", "figure08"]
NAMES = list(gallery.titles())

HASHES = Path(__file__).with_name("pictures.json")
SIZE, LOW = 64, 16  # pixels that a picture is reduced to, frequencies that count

DIFFERENT = 40
"""Bits out of 256 that may differ where fonts do; unrelated pictures differ in some 100."""

LINES = 60  # of code, without docstring and blank lines


def pixels(picture: Path) -> np.ndarray:
    """Darkness of every pixel, 0 for white paper, 1 for black."""
    with Image.open(picture) as image:
        return 1 - np.asarray(image.convert("L"), float) / 255


def perceptual_hash(picture: Path) -> str:
    """Hash of a picture: 256 bits as 64 hexadecimal digits."""
    with Image.open(picture) as image:
        small = image.convert("L").resize((SIZE, SIZE), Image.Resampling.BOX)
    low = dctn(np.asarray(small, float))[:LOW, :LOW].ravel()
    return np.packbits(low > np.median(low)).tobytes().hex()


def difference(one: str, other: str) -> int:
    """Number of bits that differ."""
    return (int(one, 16) ^ int(other, 16)).bit_count()


def stored() -> dict[str, str]:
    """Hashes of the gallery as it was last looked at, by name."""
    return json.loads(HASHES.read_text())


def store() -> None:
    """Draw the gallery and store its hashes."""
    with tempfile.TemporaryDirectory() as folder:
        results = gallery.run_all(Path(folder))
        hashes = {result["name"]: perceptual_hash(Path(result["picture"])) for result in results}
    HASHES.write_text(json.dumps(hashes, indent=1, sort_keys=True) + "\n")


def lines_of_code(script: Path) -> int:
    source = script.read_text()
    start = ast.parse(source).body[0].end_lineno
    return sum(bool(line.strip()) for line in source.splitlines()[start:])


def test_every_row_is_there_and_nothing_else():
    assert len(TABLE_2) == 46
    assert sorted(NAMES) == sorted(TABLE_2 + NAMED_IN_THE_TEXT + FURTHER_WORK + FIGURES)
    assert sorted(stored()) == sorted(NAMES)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("gallery")


@pytest.mark.parametrize("name", NAMES)
def test_figures_hold_their_bounds_and_the_picture_is_as_it_was(name, folder):
    result = gallery.run(name, folder)
    assert result["figures"]
    for shown in result["figures"]:
        assert math.isfinite(shown["value"]), shown
        assert shown["holds"], shown
        assert len(shown["reason"]) > 3, shown
        assert None in (shown["least"], shown["greatest"]) or shown["least"] <= shown["greatest"]
    picture = Path(result["picture"])
    darkness = pixels(picture)
    assert 0.005 < (darkness > 0.1).mean() < 0.6  # neither blank nor covered
    assert min(darkness.shape) > 150
    assert difference(perceptual_hash(picture), stored()[name]) <= DIFFERENT


@pytest.mark.parametrize("name", NAMES)
def test_a_script_is_short_and_says_what_to_look_for(name):
    script = DEMOS / f"{name}.py"
    assert lines_of_code(script) <= LINES
    text = ast.get_docstring(ast.parse(script.read_text()))
    title, look_for = text.split("\n\n", 1)
    assert title.startswith(f"{name}: ")
    assert look_for.startswith("Look for: ")


def test_a_hash_tells_pictures_apart_and_forgives_another_font(folder):
    hashes = stored()
    apart = [difference(hashes["demo_GMM01"], hashes[name]) for name in ("demo_IK01", "figure06")]
    assert min(apart) > 1.5 * DIFFERENT
    with rc_context({"font.family": "serif", "font.size": 11}):
        other = perceptual_hash(Path(gallery.run("demo_OC_LQT01", folder)["picture"]))
    assert 0 < difference(other, hashes["demo_OC_LQT01"]) <= DIFFERENT


def test_pictures_of_the_documentation_are_as_the_demos_draw_them():
    pictures = list((DEMOS.parent / "docs" / "pictures").glob("*.png"))
    assert len(pictures) > 3
    for picture in pictures:
        assert difference(perceptual_hash(picture), stored()[picture.stem]) <= DIFFERENT


def test_a_demo_gives_the_same_numbers_again(folder):
    one, two = (gallery.run("figure08", folder)["figures"] for _ in range(2))
    assert [shown["value"] for shown in one] == [shown["value"] for shown in two]
    assert np.ptp([shown["value"] for shown in one]) > 0


if __name__ == "__main__":
    store()
