import numpy

from tpsim.cli import doctor
from tpsim.experiment import gallery


def test_what_is_here_is_listed(monkeypatch):
    monkeypatch.setattr(doctor.rendering, "backend", lambda: "egl")
    found = doctor.examine()
    assert found["versions"]["numpy"] == numpy.__version__
    assert found["machine"]["renderer"] == "egl"
    assert found["machine"]["cores"] >= 1
    assert not [line for line in found["missing"] if "film" in line["missing"]]


def test_what_is_missing_has_a_command_that_mends_it(monkeypatch, tmp_path):
    monkeypatch.setattr(doctor.rendering, "backend", lambda: None)
    monkeypatch.setattr(doctor, "_encoder", lambda: None)
    monkeypatch.setattr(doctor, "versions", lambda: {"numpy": "2", "no-such-package": None})
    monkeypatch.setattr(doctor.paths, "MODELS", tmp_path)
    missing = {line["missing"]: line["command"] for line in doctor.examine()["missing"]}
    assert "pip install no-such-package" in missing["package no-such-package"]
    assert missing["offscreen rendering, for films"].startswith("apt-get install")
    assert "pip install 'imageio[ffmpeg]'" in missing["FFmpeg, for films"]
    assert f"the files of {tmp_path}" in missing


def test_demos_are_listed_and_run(monkeypatch, tmp_path):
    monkeypatch.setattr(gallery.paths, "DEMOS", tmp_path)
    (tmp_path / "demo_one.py").write_text(
        '"""Title: one.\n\nMore."""\ndef main():\n return {"x": 1}'
    )
    (tmp_path / "_shared.py").write_text("")
    assert gallery.titles() == {"demo_one": "Title: one."}
    assert gallery.run("demo_one") == {
        "demo": "demo_one",
        "title": "Title: one.",
        "figures": {"x": 1},
    }
