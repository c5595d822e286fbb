"""The demos as sphinx-gallery wants them: a folder for every section of the tutorial, and titles.

Scripts are copied as they are. Their pages get a title from the first line of the docstring, and
the picture that ``tpsim.gallery.present`` writes.
"""

import builtins
import re
import shutil
from pathlib import Path

from tpsim.paths import DEMOS

SECTIONS = {
    "frames": (
        "Frames and mixtures (Sections 2 and 3)",
        ["figure03", "demo_affineTransform01", "demo_GMM01", "demo_TPGMM01", "figure04"],
    ),
    "subspaces": (
        "Subspaces (Section 4)",
        ["demo_GMM_HDDC01", "demo_GMM_MFA01", "demo_GMM_MPPCA01", "figure05", "demo_TPHDDC01",
         "demo_TPMFA01", "demo_TPMPPCA01", "figure06"],
    ),
    "regression": (
        "Gaussian mixture regression (Section 5.1)",
        ["demo_GMR01", "demo_TPGMR01", "demo_DTW01", "demo_DMP_GMR01", "demo_DMP_GMR02",
         "demo_DMP_GMR03", "demo_DMP_GMR04", "demo_DMP_GMR_LQR01"],
    ),
    "trajectories": (
        "Dynamic features and trajectory distributions (Section 5.2)",
        ["demo_trajGMM01", "demo_trajHSMM01", "demo_TPtrajGMM01", "figure08", "demo_TPproMP01",
         "demo_TPtrajDistrib01"],
    ),
    "control": (
        "Minimal intervention control (Section 6)",
        ["demo_spring01", "demo_OC_LQT01", "demo_OC_LQT02", "demo_OC_LQT_infHor01",
         "demo_OC_LQT_infHor02", "demo_OC_LQT_infHor03", "demo_OC_LQT_infHor04",
         "demo_OC_LQT_recursive01", "demo_OC_LQT_recursive02", "demo_OC_LQT_recursive03",
         "demo_TPLQT01"],
    ),
    "projections": (
        "Joint space, task space, priorities (Section 7)",
        ["demo_IK01", "demo_IK02", "demo_IK_expForm01", "demo_IK_pointing_TPGMM01",
         "demo_IK_nullspace_TPGMM01"],
    ),
    "comparison": (
        "Comparison with other methods (Section 8)",
        ["demo_GPR01", "demo_TPGP01", "demo_stdPGMM01", "benchmark_DS_TP_GMM01",
         "benchmark_DS_TP_MFA01", "benchmark_DS_TP_trajGMM01", "benchmark_DS_TP_GP01",
         "benchmark_DS_TP_LWR01", "benchmark_DS_GP_raw01", "benchmark_DS_GP_GMM01",
         "benchmark_DS_PGMM01"],
    ),
    "further": ("Multilinear analysis (Section 9)", ["demo_eigenframes01"]),
}  # fmt: skip
"""Where every demo stands in the gallery: folder, title, demos in the order in which to read."""

PICTURES = Path("recordings/runs/gallery")
"""Where a demo writes its picture, from the folder in which sphinx-gallery runs it."""


def page(name: str) -> str:
    """Document of a demo, as Sphinx names it."""
    return f"/gallery/{section(name)}/{name}"


def section(name: str) -> str:
    """Folder of a demo."""
    (folder,) = (key for key, (_, demos) in SECTIONS.items() if name in demos)
    return folder


def lay_out(folder: Path) -> None:
    """Copy the scripts into folders by section; what did not change keeps its file."""
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    shutil.copy2(DEMOS / "README.rst", folder / "README.rst")
    for key, (title, demos) in SECTIONS.items():
        (folder / key).mkdir()
        (folder / key / "README.rst").write_text(f"{title}\n{'-' * len(title)}\n", "utf-8")
        for name in demos:
            shutil.copy2(DEMOS / f"{name}.py", folder / key)


class InOrder:
    """Key by which sphinx-gallery sorts the scripts of a section."""

    def __init__(self, folder: str):
        self.demos = SECTIONS[Path(folder).name][1] if Path(folder).name in SECTIONS else []

    def __call__(self, file: str) -> int:
        """Place of a script."""
        return self.demos.index(Path(file).stem)


def know_its_file(gallery_conf, script: str) -> None:
    """Let a demo name its file, which sphinx-gallery's own namespace does not have."""
    builtins.__file__ = script


def picture(block, block_vars, gallery_conf) -> str:
    """Scraper: take over the picture that the script has just written."""
    from sphinx_gallery.scrapers import figure_rst

    script = Path(block_vars["src_file"])
    written = script.parent / PICTURES / f"{script.stem}.png"
    if not written.exists():
        return ""
    target = next(iter(block_vars["image_path_iterator"]))
    shutil.move(written, target)
    return figure_rst([target], gallery_conf["src_dir"])


def titled(name: str, text: str) -> str:
    """The page of a demo with the heading that its docstring implies."""
    said = re.compile(rf"^{name}: (.)(.*?)\n\nLook for: (.)", re.M | re.S)

    def heading(match: re.Match) -> str:
        first, rest, look = match.groups()
        line = "=" * len(name)
        return f"{name}\n{line}\n\n{first.upper()}{rest}\n\n**Look for:** {look}"

    return said.sub(heading, text, count=1)
