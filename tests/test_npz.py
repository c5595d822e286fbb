import io
import zipfile

import numpy as np
import pytest

from tpsim.errors import RecordingError
from tpsim.npz import read_members, write_members


def npy(header, content=b""):
    """An array file with a header of one's own."""
    text = repr(header).encode().ljust(117) + b"\n"
    return b"\x93NUMPY\x01\x00" + len(text).to_bytes(2, "little") + text + content


def write(path, members, **options):
    with zipfile.ZipFile(path, "w", **options) as archive:
        for name, content in members.items():
            archive.writestr(name, content)
    return path


def header(shape, descr="<f8"):
    return {"descr": descr, "fortran_order": False, "shape": shape}


def plain(array):
    buffer = io.BytesIO()
    np.save(buffer, array, allow_pickle=False)
    return buffer.getvalue()


@pytest.fixture
def whole(tmp_path):
    arrays = {"x": np.random.default_rng(0).normal(size=(50, 3)), "empty": np.zeros((0, 3))}
    return write_members(tmp_path / "a.npz", arrays)


def test_arrays_come_back(whole):
    back = read_members(whole)
    np.testing.assert_array_equal(back["x"], np.random.default_rng(0).normal(size=(50, 3)))
    assert back["empty"].shape == (0, 3)


def test_no_file_is_said(tmp_path):
    with pytest.raises(RecordingError, match="there is no file"):
        read_members(tmp_path / "nothing.npz")
    with pytest.raises(RecordingError, match="there is no file"):
        read_members(tmp_path)


@pytest.mark.parametrize("keep", [0, 10, 200, 0.5, 0.9, 0.999])
def test_a_truncated_file_is_refused_in_one_line(whole, keep):
    content = whole.read_bytes()
    whole.write_bytes(content[: keep if isinstance(keep, int) else int(keep * len(content))])
    with pytest.raises(RecordingError, match=r"truncated.*record again") as error:
        read_members(whole)
    assert "\n" not in str(error.value)


def test_any_changed_byte_is_noticed_or_changes_nothing(whole):
    content, before = whole.read_bytes(), read_members(whole)
    rng = np.random.default_rng(0)
    noticed = 0
    for place in rng.choice(len(content), 300, replace=False):
        tampered = bytearray(content)
        tampered[place] ^= 1 << rng.integers(8)
        whole.write_bytes(tampered)
        try:
            after = read_members(whole)
        except RecordingError:
            noticed += 1
        else:
            # Names are not covered by checksums, contents are; readers ask for names.
            if len(after) < len(before):
                noticed += 1
                continue
            for one, other in zip(before.values(), after.values(), strict=True):
                np.testing.assert_array_equal(one, other)
    assert noticed > 200


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (npy(header((2**44,))), "claims 140737488355"),
        (npy(header((2**62, 2**62))), "claims"),
        (npy(header((-1, -8)), b"x" * 64), "arrays hold numbers"),
        (npy(header((10,)), b"x" * 8), "claims 208 bytes, it has 136"),
        (npy(header((1,)), b"x" * 80), "claims 136 bytes"),
        (npy(header((1,), "|O"), b"x" * 8), "arrays hold numbers or text"),
        (npy(header((1,), "<M8[s]"), b"x" * 8), "arrays hold numbers or text"),
        (npy(header((1,), [("a", "<f8")]), b"x" * 8), "arrays hold numbers or text"),
        (npy(header(("1",)), b"x" * 8), "truncated or no recording"),
        (npy("__import__('os').abort()"), "truncated or no recording"),
        (b"no array", "truncated or no recording"),
    ],
)
def test_headers_that_lie_are_refused_before_anything_is_allocated(tmp_path, content, words):
    path = write(tmp_path / "a.npz", {"x.npy": content})
    with pytest.raises(RecordingError, match=words):
        read_members(path)


def test_compressed_archives_are_refused_unopened(tmp_path):
    bomb = plain(np.zeros(10**6))
    path = write(tmp_path / "a.npz", {"x.npy": bomb}, compression=zipfile.ZIP_DEFLATED)
    assert path.stat().st_size < 10_000
    with pytest.raises(RecordingError, match="it is compressed"):
        read_members(path)


def test_members_that_share_their_bytes_are_refused(tmp_path):
    path = write(tmp_path / "a.npz", {"x.npy": plain(np.zeros(1000)), "y.npy": b""})
    content = path.read_bytes()
    start = content.index(b"PK\x01\x02")
    entry = content[start : content.index(b"PK\x01\x02", start + 1)]
    # A thousand entries of the directory that all show the same array.
    copies = [entry.replace(b"x.npy", f"{i:05d}".encode()) for i in range(1000)]
    directory = b"".join(copies)
    end = bytearray(content[content.index(b"PK\x05\x06") :])
    end[8:12] = (1000).to_bytes(2, "little") * 2
    end[12:20] = len(directory).to_bytes(4, "little") + start.to_bytes(4, "little")
    path.write_bytes(content[:start] + directory + end)
    with pytest.raises(RecordingError, match="it claims 8128000 bytes"):
        read_members(path)


def test_too_many_arrays_are_refused(tmp_path):
    path = write(tmp_path / "a.npz", {f"{i}.npy": plain(np.zeros(1)) for i in range(1025)})
    with pytest.raises(RecordingError, match="1025 arrays"):
        read_members(path)
