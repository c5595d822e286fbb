import pytest

from tpsim.errors import RecordingError
from tpsim.study.files.scene_check import check_scene

ASSETS = {"mark.obj": b"v 0 0 0", "wood.png": b"\x89PNG\r\n\x1a\n" + bytes(20)}
SCENE = "<mujoco>{}<asset><mesh file='mark.obj'/></asset></mujoco>"


def test_a_scene_that_holds_all_it_needs_passes(toy):
    check_scene(toy.task.stage.xml, toy.task.stage.assets, "scene.xml")
    check_scene(SCENE.format("<option timestep='0.002'/><size memory='10M'/>"), ASSETS, "scene.xml")


@pytest.mark.parametrize(
    ("inner", "words"),
    [
        ("<asset><mesh file='/etc/passwd'/></asset>", "mesh file='/etc/passwd'> is not among"),
        ("<asset><mesh file='../mark.obj'/></asset>", "is not among its files"),
        ("<asset><hfield file='other.png'/></asset>", "hfield file='other.png'> is not among"),
        ("<asset><texture fileright='/a.png'/></asset>", "fileright='/a.png'> is not among"),
        ("<deformable><skin file='a.skn'/></deformable>", "skin file='a.skn'> is not among"),
        ("<asset><model file='mark.obj'/></asset>", "an element <model>"),
        ("<include file='mark.obj'/>", "an element <include>"),
        ("<extension><plugin plugin='x'/></extension>", "an element <extension>"),
        ("<worldbody><geom><plugin instance='x'/></geom></worldbody>", "an element <plugin>"),
        ("<worldbody><replicate count='9999999'/></worldbody>", "an element <replicate>"),
        ("<worldbody><composite count='9 9 9'/></worldbody>", "an element <composite>"),
        ("<compiler meshdir='/etc'/>", "compiler meshdir='/etc'> names a folder"),
        ("<compiler assetdir='..'/>", "names a folder"),
        ("<option timestep='1e-7'/>", "is not in 1e-05 to 0.1 s"),
        ("<option timestep='nan'/>", "is not in 1e-05 to 0.1 s"),
        ("<option timestep='x'/>", "is not in 1e-05 to 0.1 s"),
        ("<option iterations='1000000000'/>", "is more than 4096"),
        ("<asset><texture builtin='flat' width='100000' height='1'/></asset>", "more than 8192"),
        ("<asset><hfield nrow='100000' ncol='100000'/></asset>", "is more than 4096"),
        ("<asset><mesh builtin='sphere' params='9 100000'/></asset>", "is more than 512"),
        ("<custom><numeric name='x' size='1000000000'/></custom>", "is more than 4096"),
        ("<sensor><user dim='1000000000'/></sensor>", "is more than 4096"),
        ("<size memory='100G'/>", "is more than 1 G"),
        ("<size memory='99999999999'/>", "is more than 1 G"),
        ("<size memory='1T'/>", "is more than 1 G"),
        ("<size nuser_body='1000000000'/>", "is more than 4096"),
        ("<mujoco", "it is no XML"),
    ],
)
def test_what_opens_loads_or_fills_the_memory_is_refused(inner, words):
    with pytest.raises(RecordingError, match=words) as error:
        check_scene(SCENE.format(inner), ASSETS, "scene.xml")
    assert str(error.value).startswith("scene.xml: ")
    assert "\n" not in str(error.value)


def test_entities_are_refused():
    bomb = "<!DOCTYPE m [<!ENTITY a 'aaaa'><!ENTITY b '&a;&a;'>]><mujoco>&b;</mujoco>"
    with pytest.raises(RecordingError, match="DOCTYPE"):
        check_scene(bomb, {}, "scene.xml")


def test_huge_pictures_and_names_with_folders_are_refused():
    size = (100_000).to_bytes(4, "big")
    huge = {"a.png": b"\x89PNG\r\n\x1a\n" + bytes(8) + size + size}
    with pytest.raises(RecordingError, match=r"picture 'a\.png' has more than"):
        check_scene("<mujoco/>", huge, "scene.xml")
    for name in ("../a.obj", "/a.obj", "b/a.obj", "b\\a.obj", ".a", ""):
        with pytest.raises(RecordingError, match="is no plain name"):
            check_scene("<mujoco/>", {name: b""}, "scene.xml")
