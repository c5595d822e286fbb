import numpy

from tpsim.cli import doctor


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
