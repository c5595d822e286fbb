"""What a file does not say, and what headings say: units, orders, rates, names of recorders."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from tpsim import TpsimError
from tpsim.data import Columns, PoseColumns, frames_from, poses_in, read, recordings
from tpsim.data.orientation import left_multiplication, quaternions
from tpsim.data.units import name_and_unit


def written(tmp_path, text, name="a.csv"):
    path = tmp_path / name
    path.write_text(text)
    return path


def table(names, rows, separator=","):
    lines = [separator.join(names)]
    return "\n".join([*lines, *(separator.join(map(repr, map(float, row))) for row in rows)]) + "\n"


@pytest.mark.parametrize(
    ("heading", "name", "unit"),
    [
        ("x [mm]", "x", "mm"),
        ("time (ms)", "time", "ms"),
        (" #timestamp [ns]", "#timestamp", "ns"),
        ("q_RS_w []", "q_RS_w", None),
        ("v [m s^-1]", "v", "m s^-1"),
        ("state.q[0]", "state.q[0]", None),
        ('"angle [°]"', "angle", "deg"),
    ],
)
def test_headings(heading, name, unit):
    assert name_and_unit(heading) == (name, unit)


def test_units_of_headings_and_of_the_description(tmp_path):
    rows = [[0, 1000, 2000, 90], [10, 1100, 2100, 180]]
    said = written(tmp_path, table(["t [ms]", "x [mm]", "y [mm]", "a [deg]"], rows))
    silent = written(tmp_path, table(["t", "x", "y", "a"], rows), "b.csv")
    names = {"position": ["x", "y"], "joints": "a"}
    units = {"time_unit": "ms", "length_unit": "mm", "angle_unit": "deg"}
    for path, columns in ((said, Columns(**names)), (silent, Columns(**names, **units))):
        (d,) = read(path, columns)
        np.testing.assert_allclose(d.time, [0, 0.01])
        np.testing.assert_allclose(d.data, [[1, 2, np.pi / 2], [1.1, 2.1, np.pi]])


@pytest.mark.parametrize(
    ("factor", "name"), [(10**9, "stamp"), (10**6, "t_us"), (10**3, "time_ms")]
)
def test_units_of_stamps_by_size_or_name(tmp_path, factor, name):
    rows = [f"{1_700_000_000 * factor + i * factor // 64},{i}" for i in range(2)]
    path = written(tmp_path, "\n".join([f"{name},x", *rows]))
    (d,) = read(path)
    np.testing.assert_allclose(d.time, [0, 1 / 64], atol=1 / factor)


def test_no_headings_need_numbers_and_a_rate_or_a_time(tmp_path):
    path = written(tmp_path, "0.0 1 2\n0.1 3 4\n0.2 5 6\n", "a.txt")
    with pytest.raises(TpsimError, match=r"Columns\(time=.*Columns\(rate=.*there are c0, c1, c2"):
        read(path)
    (d,) = read(path, Columns(time=0))
    np.testing.assert_array_equal(d.data, [[1, 2], [3, 4], [5, 6]])
    np.testing.assert_array_equal(d.time, [0, 0.1, 0.2])
    (d,) = read(path, Columns(rate=50, position=(1, 2)))
    np.testing.assert_allclose(d.time, [0, 0.02, 0.04])


@pytest.mark.parametrize("separator", [",", "\t", ";", " ", "   "])
def test_separators(tmp_path, separator):
    (d,) = read(written(tmp_path, table(["t", "x", "y"], [[0, 1, 2], [1, 3, 4]], separator)))
    np.testing.assert_array_equal(d.data, [[1, 2], [3, 4]])


def test_decimal_commas_marks_and_words(tmp_path):
    (d,) = read(written(tmp_path, "\ufefft;x;y\r\n0,0;1,5;2,5\r\n0,1;2,5;3,5\r\n"))
    np.testing.assert_array_equal(d.data, [[1.5, 2.5], [2.5, 3.5]])
    text = "% logged today\n% by hand\nt,label,x,y,\n0,open,1,2,\n1,closed,3,4,\n"
    (d,) = read(written(tmp_path, text, "b.csv"))
    np.testing.assert_array_equal(d.data, [[1, 2], [3, 4]])


def test_libfranka(tmp_path):
    names = ["time", "success_rate", *(f"state.q[{i}]" for i in range(7))]
    names += [f"cmd.O_T_EE_d[{i}]" for i in range(16)]
    T = np.eye(4)
    T[:3, :3] = Rotation.from_rotvec([0.1, 0.2, 0.3]).as_matrix()
    T[:3, 3] = 0.3, 0.1, 0.5
    rows = [[i, 1, *np.arange(7) + 0.1 * i, *T.T.ravel()] for i in range(3)]
    path = written(tmp_path, table(names, rows))
    (d,) = read(path)
    np.testing.assert_allclose(d.time, [0, 1e-3, 2e-3])
    np.testing.assert_allclose(d.data[2], np.arange(7) + 0.2)
    where = [f"cmd.O_T_EE_d[{i}]" for i in (12, 13, 14)]
    (d,) = read(path, Columns(position=where, orientation="cmd.O_T_EE_d", order="pose"))
    turn = Rotation.from_rotvec([0.1, 0.2, 0.3]).as_quat(scalar_first=True)
    np.testing.assert_allclose(d.data[0], [0.3, 0.1, 0.5, *turn])
    np.testing.assert_allclose(d.time, [0, 1e-3, 2e-3])


def test_universal_robots(tmp_path):
    names = ["timestamp", *(f"actual_q_{i}" for i in range(6))]
    names += [f"actual_TCP_pose_{i}" for i in range(6)]
    rows = [[0.002 * i, *range(6), 1, 2, 3, 0, 0, np.pi / 2] for i in range(3)]
    path = written(tmp_path, table(names, rows, " "))
    (d,) = read(path)
    np.testing.assert_array_equal(d.data[1], range(6))
    pose = [f"actual_TCP_pose_{i}" for i in range(6)]
    (d,) = read(path, Columns(position=pose[:3], orientation=pose[3:], order="rotvec"))
    np.testing.assert_allclose(d.data[1], [1, 2, 3, np.sqrt(0.5), 0, 0, np.sqrt(0.5)])


def test_joint_states_as_rostopic_and_plotjuggler_write_them(tmp_path):
    ros = (
        "%time,field.header.frame_id,field.name0,field.position0,field.position1,field.velocity0\n"
    )
    ros += "".join(
        f"{1_700_000_000_000_000_000 + i * 10_000_000},,j,{i},{i + 5},0\n" for i in (0, 1)
    )
    (d,) = read(written(tmp_path, ros))
    np.testing.assert_allclose(d.time, [0, 0.01], atol=1e-12)
    np.testing.assert_array_equal(d.data, [[0, 5], [1, 6]])
    names = ["__time", "/joint_states/a/position", "/joint_states/b/position", "/x/effort"]
    (d,) = read(written(tmp_path, table(names, [[0, 1, 2, 9], [1, 3, 4, 9]]), "b.csv"))
    np.testing.assert_array_equal(d.data, [[1, 2], [3, 4]])


def test_several_demonstrations_in_one_table(tmp_path):
    rows = [[0, 7, 1], [1, 7, 2], [0, 3, 3], [2, 3, 4], [4, 3, 5]]
    path = written(tmp_path, table(["t", "run", "x"], rows))
    first, second = read(path, Columns(demonstration="run"))
    np.testing.assert_array_equal(first.data[:, 0], [1, 2])
    np.testing.assert_array_equal(second.time, [0, 2, 4])
    path = written(tmp_path, table(["t", "episode", "x"], rows), "b.csv")
    first, second = read(path)  # under a usual name it need not be said
    np.testing.assert_array_equal(second.data, [[3], [4], [5]])


turns = st.lists(st.floats(-3, 3), min_size=3, max_size=3).filter(
    lambda v: np.linalg.norm(v) > 1e-3
)


@settings(max_examples=40, deadline=None)
@given(turns, turns)
def test_every_order_is_the_same_orientation(one, other):
    R = Rotation.from_rotvec([one, other])
    expected = R.as_quat(scalar_first=True)
    T = np.tile(np.eye(4), (2, 1, 1))
    T[:, :3, :3] = R.as_matrix()
    for order, values in {
        "wxyz": -3 * expected,
        "xyzw": R.as_quat(),
        "rotvec": R.as_rotvec(),
        "matrix": R.as_matrix().reshape(2, 9),
        "pose": T.mT.reshape(2, 16),
    }.items():
        found = quaternions(values, order)
        np.testing.assert_allclose(np.abs(np.sum(found * expected, axis=1)), 1, atol=1e-9)
    product = left_multiplication(expected[0]) @ expected[1]
    cosine = product @ (R[0] * R[1]).as_quat(scalar_first=True)
    assert abs(cosine) == pytest.approx(1)


def test_euler_angles_in_degrees(tmp_path):
    rows = [[0, 0, 0, 0, 90, 0, 0], [1, 0, 0, 0, 90, 0, 45]]
    path = written(tmp_path, table(["t", "x", "y", "z", "yaw", "pitch", "roll"], rows))
    angles = ["yaw", "pitch", "roll"]
    columns = Columns(position=list("xyz"), orientation=angles, order="ZYX", angle_unit="deg")
    (d,) = read(path, columns)
    expected = Rotation.from_euler("ZYX", [90, 0, 45], degrees=True).as_quat(scalar_first=True)
    assert abs(d.data[1, 3:] @ expected) == pytest.approx(1)


def test_signs_of_quaternions_agree_inside_and_across(tmp_path):
    rng = np.random.default_rng(0)
    for n in range(4):
        time = np.linspace(0, 1, 50)
        q = Rotation.from_rotvec(np.outer(time, [0, 0, 2.5]) + 0.05 * n).as_quat(scalar_first=True)
        box = Rotation.from_euler("z", 3 + 0.1 * n).as_quat(scalar_first=True)
        q *= rng.choice([-1, 1], (50, 1))
        rows = np.column_stack([time, np.zeros((50, 3)), q, np.zeros((50, 3))])
        rows = np.hstack([rows, np.tile(box * rng.choice([-1, 1]), (50, 1))])
        names = ["t", *"xyz", "qw", "qx", "qy", "qz"]
        names += [f"b_{part}" for part in ("x", "y", "z", "qw", "qx", "qy", "qz")]
        written(tmp_path, table(names, rows), f"{n}.csv")
    columns = Columns(position=list("xyz"), orientation="q?", order="wxyz", frames=["b"])
    found = read(tmp_path, columns)
    for d in found:
        assert (np.sum(d.data[1:, 3:] * d.data[:-1, 3:], axis=1) > 0).all()
        for view, other in (
            (d.data[:, 3:], found[0].data[:, 3:]),
            (d.observations[0][:, 3:], found[0].observations[0][:, 3:]),
        ):
            assert (np.sum(view * other, axis=1) > 0.9).all()


def test_frames_move_or_stay_at_the_start():
    time = np.linspace(0, 1, 5)
    turn = Rotation.from_euler("z", time[:, None])
    trial = {
        "time": time,
        "hand_position": np.column_stack([time, time, 0 * time]),
        "cup_position": np.column_stack([0 * time, time, 0 * time]),
        "cup_quaternion": turn.as_quat(scalar_first=True),
    }
    (still,) = frames_from(trial, Columns(position="hand_position", frames=["cup"]))
    np.testing.assert_allclose(still.A, np.eye(3), atol=1e-15)
    (moving,) = frames_from(trial, Columns(position="hand_position", frames=["cup"], moving=True))
    np.testing.assert_allclose(moving.A, turn.as_matrix(), atol=1e-12)
    np.testing.assert_allclose(moving.b, trial["cup_position"])
    start, end = frames_from(trial, Columns(position="hand_position", frames=["start", "end"]))
    np.testing.assert_allclose(end.b - start.b, [1, 1, 0])


def test_frames_in_the_plane(tmp_path):
    rows = [[0, 1, 1, 2, 1, np.pi / 2], [1, 2, 3, 2, 1, np.pi / 2]]
    path = written(tmp_path, table(["t", "x", "y", "goal_x", "goal_y", "goal_theta"], rows))
    (d,) = read(path, Columns(frames=["goal"]))
    np.testing.assert_allclose(d.observations[0], [[0, 1], [2, 0]], atol=1e-12)


def test_joints_are_the_same_from_every_object(tmp_path):
    names = ["t", "x", "y", "z", "q0", "q1", "box_x", "box_y", "box_z"]
    path = written(
        tmp_path, table(names, [[0, 1, 2, 3, 4, 5, 1, 1, 1], [1, 1, 2, 3, 4, 5, 1, 1, 1]])
    )
    columns = Columns(position=list("xyz"), joints=["q0", "q1"], frames=["box", "start"])
    (d,) = read(path, columns)
    np.testing.assert_array_equal(d.observations[0][0], [0, 1, 2, 4, 5])
    np.testing.assert_array_equal(d.observations[1], np.zeros((2, 5)))


def test_poses_by_the_names_of_their_columns(tmp_path):
    names = [
        "t",
        "tx",
        "ty",
        "tz",
        "qx",
        "qy",
        "qz",
        "qw",
        "vx",
        "vy",
        "vz",
        "cup.pos_x",
        "cup.pos_y",
    ]
    names += ["cup.pos_z", "box/pose/position/x", "box/pose/position/y", "box/pose/position/z"]
    names += [f"box/pose/orientation/{axis}" for axis in "xyzw"]
    (recording,) = recordings(written(tmp_path, table(names, np.ones((2, len(names))))))
    poses = poses_in(recording)
    assert set(poses) == {"", "cup", "box"}
    assert poses[""].orientation == ("qw", "qx", "qy", "qz")
    assert poses["box"].orientation[0] == "box/pose/orientation/w"
    assert poses["cup"] == PoseColumns("cup", ("cup.pos_x", "cup.pos_y", "cup.pos_z"))


GOOD = [[0.0, 1, 2, 3, 1, 0, 0, 0], [0.1, 1, 2, 3, 1, 0, 0, 0], [0.2, 1, 2, 3, 1, 0, 0, 0]]


@pytest.mark.parametrize(
    ("row", "column", "value", "words"),
    [
        (1, 2, np.nan, r"position is not a number in row 1 \(line 3\)"),
        (2, 5, np.nan, r"orientation is not a number in row 2 \(line 4\)"),
        (1, 0, np.inf, r"time is not a number in row 1 \(line 3\)"),
        (2, 0, 0.1, r"the stamp of row 2 \(line 4\), 0.1 s, repeats that of row 1"),
        (2, 0, 0.05, r"the stamp of row 2 \(line 4\), 0.05 s, goes back behind that of row 1"),
        (1, 4, 0.0, r"the quaternion qw has length zero in row 1 \(line 3\)"),
    ],
)
def test_bad_rows_are_named_or_dropped(tmp_path, row, column, value, words):
    rows = [list(r) for r in GOOD]
    rows[row][column] = value
    path = written(tmp_path, table(["t", "x", "y", "z", "qw", "qx", "qy", "qz"], rows))
    with pytest.raises(TpsimError, match=words) as caught:
        read(path)
    assert "\n" not in str(caught.value)
    (d,) = read(path, Columns(bad_rows="drop"))
    np.testing.assert_array_equal(d.time, np.delete([0, 0.1, 0.2], row))


def test_many_bad_rows_are_counted(tmp_path):
    rows = [[i, 1 if i % 3 else np.nan] for i in range(30)]
    path = written(tmp_path, table(["t", "x"], rows))
    with pytest.raises(TpsimError, match=r"in 10 rows: 0, 3, 6, 9, 12, \.\.\. \(line 2 first\)"):
        read(path)


def test_a_gap_in_the_text_is_a_bad_row(tmp_path):
    path = written(tmp_path, "t,x,y\n0,1,2\n1,,4\n2,5,6\n")
    with pytest.raises(TpsimError, match=r"position is not a number in row 1 \(line 3\)"):
        read(path)
    assert len(read(path, Columns(bad_rows="drop"))[0]) == 2


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("t,x,y\n0,1,2\n1,2\n", r"row 1 \(line 3\) has 2 fields and row 0 has 3"),
        ("t,x,y\n0,1,2\n1,2,abc\n", r"row 1 \(line 3\) has 'abc' in column y"),
        ("t,x\n0,1,2\n", "heading names 2 columns and row 0"),
        ("t,x,x\n0,1,2\n", "two columns have the same name"),
        ("t,x\n", "no rows of numbers"),
        ("a\nb\nc\n", "line 2 holds no numbers"),
        ("t,x\n0,nan\n", "position|x|other"),
        ("\n\n", "empty"),
    ],
)
def test_tables_that_are_none(tmp_path, text, words):
    with pytest.raises(TpsimError, match=words):
        read(written(tmp_path, text))


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        ({"joints": "q"}, r"no column 'q'; there are .*box_x"),
        ({"joints": 99}, "no column 99"),
        ({"time": "stamp"}, "no column 'stamp'"),
        ({"frames": ["cup"]}, "no pose is called 'cup'; the poses found are .*box"),
        ({"position": ["x", "y"], "frames": ["box"]}, "3 position columns and the movement 2"),
        ({"position": ["x", "y", "z", "time"]}, "position has 4 columns"),
        ({"position": list("xyz"), "orientation": ["qx", "qy"]}, "2 columns; the order 'wxyz'"),
        ({"orientation": ["qx"], "order": "abc"}, "order is 'abc'"),
        ({"frames": [PoseColumns("p", "x")]}, "frame 'p' has 1 position columns"),
        ({"demonstration": "run"}, "no column 'run'"),
    ],
)
def test_descriptions_that_do_not_fit_the_file(sample, columns, words):
    with pytest.raises(TpsimError, match=words):
        read(sample("text_csv"), Columns(**columns))


@pytest.mark.parametrize(
    ("columns", "words"),
    [
        ({"time_unit": "h"}, "time_unit is 'h'; give one of s, ms"),
        ({"rate": 0}, "rate is 0"),
        ({"bad_rows": "mend"}, "bad_rows is 'mend'"),
    ],
)
def test_descriptions_that_are_wrong(columns, words):
    with pytest.raises(TpsimError, match=words):
        Columns(**columns)


def test_mixed_lengths(tmp_path):
    np.savez(tmp_path / "a.npz", time=np.arange(5.0), x=np.zeros((5, 3)), q=np.zeros((4, 2)))
    assert read(tmp_path / "a.npz", Columns(other="x"))[0].data.shape == (5, 3)
    with pytest.raises(TpsimError, match=r"q has 4 rows and the movement 5"):
        read(tmp_path / "a.npz", Columns(other=["x", "q"]))
    np.savez(tmp_path / "b.npz", time=np.arange(5.0), x=np.zeros((5, 2)))
    with pytest.raises(TpsimError, match="b has 2 columns and a 3"):
        read([tmp_path / "a.npz", tmp_path / "b.npz"], Columns(other="x"))


def test_letters_and_tensors_of_pbdlib(tmp_path):
    from scipy.io import savemat

    rng = np.random.default_rng(0)
    cells = np.empty(2, object)
    for n in range(2):
        cells[n] = {"pos": rng.normal(size=(2, 20 + n)), "vel": np.zeros((2, 20 + n))}
    savemat(tmp_path / "G.mat", {"demos": cells})
    first, second = read(tmp_path / "G.mat")
    np.testing.assert_array_equal(second.data, cells[1]["pos"].T)
    assert len(first) == 20
    assert read(tmp_path / "G.mat", Columns(rate=10))[0].time[1] == pytest.approx(0.1)

    # Only what the frames saw: D x P x N, two demonstrations of 30 samples.
    x = rng.normal(size=(2, 60))
    s, tensor = np.zeros(2, [("p", object), ("nbData", object)]), np.zeros((2, 2, 60))
    for n in range(2):
        p = np.zeros(2, [("A", object), ("b", object)])
        for m in range(2):
            A, b = rng.normal(size=(2, 2)), rng.normal(size=(2, 1))
            p[m] = (A, b)
            rows = slice(30 * n, 30 * n + 30)
            tensor[:, m, rows] = np.linalg.solve(A, x[:, rows] - b)
        s[n] = (p, 30.0)
    savemat(tmp_path / "Data.mat", {"s": s, "Data": tensor})
    _, second = read(tmp_path / "Data.mat")
    np.testing.assert_allclose(second.data, x[:, 30:].T, atol=1e-9)
    np.testing.assert_allclose(second.observations[1], tensor[:, 1, 30:].T, atol=1e-9)


def test_time_in_front_of_pbdlibs_data(tmp_path):
    from scipy.io import savemat

    time, x = 0.02 * np.arange(10), np.random.default_rng(0).normal(size=(2, 10))
    A, b = np.eye(3), np.zeros((3, 1))
    A[1:, 1:], b[1:] = [[0, -1], [1, 0]], 5
    p = np.zeros(1, [("A", object), ("b", object)])
    p[0] = (A, b)
    s = np.zeros(1, [("p", object), ("Data0", object)])
    s[0] = (p, np.vstack([time, x]))
    savemat(tmp_path / "s.mat", {"s": s})
    (d,) = read(tmp_path / "s.mat")
    np.testing.assert_allclose(d.time, time)
    np.testing.assert_allclose(d.data, x.T)
    np.testing.assert_array_equal(d.frames[0].A, A[1:, 1:])


def test_matrices_by_name_with_a_sample_a_row_or_a_column(tmp_path):
    from scipy.io import savemat

    q = np.random.default_rng(0).normal(size=(20, 3))
    savemat(tmp_path / "m.mat", {"time": 0.1 * np.arange(20)[None], "q": q.T, "w": q})
    for name in ("q", "w"):
        (d,) = read(tmp_path / "m.mat", Columns(joints=name))
        np.testing.assert_array_equal(d.data, q)
        assert d.time[1] == pytest.approx(0.1)


def test_frames_of_arrays_need_no_time_and_an_object_may_be_given_once():
    hand = np.random.default_rng(0).normal(size=(5, 3))
    trial = {"hand_position": hand, "cup_position": np.ones((1, 3)), "outcome": "done"}
    columns = Columns(position="hand_position", frames=["cup", "end"])
    cup, end = frames_from(trial, columns)
    np.testing.assert_array_equal(cup.b, np.ones(3))
    np.testing.assert_array_equal(end.b, hand[-1])


def test_an_object_that_is_lost_at_first_is_taken_where_it_is_known(tmp_path):
    names = ["t", "x", "y", "box_x", "box_y"]
    rows = [[0, 0, 0, np.nan, np.nan], [1, 1, 1, 5, 6], [2, 2, 2, np.nan, 6]]
    (d,) = read(written(tmp_path, table(names, rows)), Columns(frames=["box"]))
    assert len(d) == 3
    np.testing.assert_array_equal(d.frames[0].b, [5, 6])
    with pytest.raises(TpsimError, match=r"frame 'box' is not a number in 2 rows: 0, 2"):
        read(tmp_path / "a.csv", Columns(frames=["box"], moving=True))


def test_a_description_does_not_change_with_the_list_it_was_made_of():
    names = ["x", "y", "z"]
    columns = Columns(position=names)
    names.append("w")
    assert columns.position == ("x", "y", "z")


@pytest.mark.parametrize("ending", ["", "Z", "+02:00"])
def test_dates_are_stamps(tmp_path, ending):
    lines = [
        f"2026-05-01T12:00:{59 + i // 4}.{i % 4 * 25:02d}0000001{ending},{i}" for i in range(4)
    ]
    (d,) = read(written(tmp_path, "\n".join(["timestamp,x", *lines])))
    np.testing.assert_allclose(d.time, [0, 0.25, 0.5, 0.75], atol=1e-12)
    lines[2] = "yesterday,2"
    with pytest.raises(TpsimError, match=r"row 2 \(line 4\) has 'yesterday' in column timestamp"):
        read(written(tmp_path, "\n".join(["timestamp,x", *lines])))
