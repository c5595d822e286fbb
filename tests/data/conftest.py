"""One movement, written in every format by the format's own library."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat
from scipy.spatial.transform import Rotation

T = 60
TIME = 0.02 * np.arange(T) + 0.003 * np.sin(np.arange(T))  # stamps are not even
TIME -= TIME[0]
POSITION = np.column_stack([0.3 * np.sin(TIME), 0.2 * TIME, 0.1 + 0.05 * np.cos(3 * TIME)])
TURN = Rotation.from_rotvec(np.outer(TIME, [0.3, -0.2, 0.9]))
QUATERNION = TURN.as_quat(scalar_first=True)
XYZW = TURN.as_quat()
JOINTS = np.sin(np.outer(TIME, np.arange(1, 4)))
BOX = np.array([0.4, -0.1, 0.2])
BOX_TURN = Rotation.from_euler("z", 0.6)
UNIX = 1_700_000_000_123_456_789
STAMPS = UNIX + np.round(TIME * 1e9).astype(np.int64)


def text_csv(folder: Path) -> Path:
    path = folder / "pose.csv"
    box = np.tile([*BOX, *BOX_TURN.as_quat()], (T, 1))
    names = "time,x,y,z,qx,qy,qz,qw,box_x,box_y,box_z,box_qx,box_qy,box_qz,box_qw"
    table = np.column_stack([TIME, POSITION, XYZW, box])
    np.savetxt(path, table, delimiter=",", header=names, comments="", fmt="%.17g")
    return path


def tum(folder: Path) -> Path:
    path = folder / "trajectory.tum"
    lines = [
        f"{s // 10**9}.{s % 10**9:09d} " + " ".join(f"{v:.17g}" for v in row)
        for s, row in zip(STAMPS, np.hstack([POSITION, XYZW]), strict=True)
    ]
    path.write_text("\n".join(lines) + "\n")
    return path


def euroc(folder: Path) -> Path:
    path = folder / "data.csv"
    header = "#timestamp, p_RS_R_x [m], p_RS_R_y [m], p_RS_R_z [m], q_RS_w [], q_RS_x [], "
    header += "q_RS_y [], q_RS_z [], v_RS_R_x [m s^-1], v_RS_R_y [m s^-1], v_RS_R_z [m s^-1]"
    rows = np.hstack([POSITION, QUATERNION, np.gradient(POSITION, TIME, axis=0)])
    lines = [
        f"{s}," + ",".join(f"{v:.17g}" for v in row) for s, row in zip(STAMPS, rows, strict=True)
    ]
    path.write_text("\n".join([header, *lines]) + "\n")
    return path


def npz(folder: Path) -> Path:
    path = folder / "trial.npz"
    np.savez(
        path,
        time=TIME,
        hand_position=POSITION,
        hand_quaternion=QUATERNION,
        box_position=np.tile(BOX, (T, 1)),
        box_quaternion=np.tile(BOX_TURN.as_quat(scalar_first=True), (T, 1)),
        outcome=np.array("done"),
    )
    return path


def mat(folder: Path) -> Path:
    path = folder / "situations.mat"
    A = np.sqrt(0.1) * np.array([[0.0, -1.0], [-1.0, 0.0]])
    frames = [(A, np.array([[1.0], [2.0]])), (np.eye(2), np.zeros((2, 1)))]
    p = np.zeros(2, [("A", object), ("b", object)])
    for m, (A, b) in enumerate(frames):
        p[m] = (A, b)
    s = np.zeros(3, [("p", object), ("Data", object), ("nbData", object)])
    for n in range(3):
        s[n] = (p, POSITION.T[:2] + n, float(T))
    savemat(path, {"s": s, "nbSamples": 3}, do_compression=True)
    return path


def rosbag1(folder: Path) -> Path:
    rosbag1 = pytest.importorskip("rosbags.rosbag1")
    types, t = _types("ROS1_NOETIC")
    path = folder / "arm.bag"
    with rosbag1.Writer(path) as bag:
        _fill(bag, types, t, types.serialize_ros1, seq=True)
    return path


def rosbag2(folder: Path) -> Path:
    rosbag2 = pytest.importorskip("rosbags.rosbag2")
    types, t = _types("ROS2_HUMBLE")
    path = folder / "arm_bag"
    with rosbag2.Writer(path, version=8) as bag:
        _fill(bag, types, t, types.serialize_cdr, seq=False)
    return path


def _types(store):
    typesys = pytest.importorskip("rosbags.typesys")
    types = typesys.get_typestore(typesys.Stores[store])
    tree = "tf2_msgs/msg/TFMessage"
    if tree not in types.types:
        text = "geometry_msgs/msg/TransformStamped[] transforms"
        types.register(typesys.get_types_from_msg(text, tree))
    return types, types.types


def _fill(bag, types, t, serialize, *, seq):
    """Joint states at 50 Hz; the hand as a pose; the box as a transform of a turning table."""
    kinds = {
        "/joint_states": "sensor_msgs/msg/JointState",
        "/hand": "geometry_msgs/msg/PoseStamped",
        "/tf": "tf2_msgs/msg/TFMessage",
    }
    to = {topic: bag.add_connection(topic, kind, typestore=types) for topic, kind in kinds.items()}

    def header(stamp, frame="world"):
        time = t["builtin_interfaces/msg/Time"](int(stamp // 10**9), int(stamp % 10**9))
        first = (0,) if seq else ()
        return t["std_msgs/msg/Header"](*first, time, frame)

    def vector(kind, p):
        return t[f"geometry_msgs/msg/{kind}"](*map(float, p))

    def transform(stamp, parent, child, p, q):
        turn = vector("Quaternion", q)
        inner = t["geometry_msgs/msg/Transform"](vector("Vector3", p), turn)
        return t["geometry_msgs/msg/TransformStamped"](header(stamp, parent), child, inner)

    names, empty = ["j1", "j2", "j3"], np.empty(0)
    table = Rotation.from_euler("z", 0.6).as_quat()
    for i, stamp in enumerate(map(int, STAMPS)):
        joints = t[kinds["/joint_states"]](header(stamp), names, JOINTS[i], empty, empty)
        pose = t["geometry_msgs/msg/Pose"](
            vector("Point", POSITION[i]), vector("Quaternion", XYZW[i])
        )
        tree = [
            transform(stamp, "world", "table", BOX, table),
            transform(stamp, "table", "box", [0.1, 0, 0], [0, 0, 0, 1]),
        ]
        messages = (joints, t[kinds["/hand"]](header(stamp), pose), t[kinds["/tf"]](tree))
        for (topic, kind), message in zip(kinds.items(), messages, strict=True):
            bag.write(to[topic], stamp + 1000, serialize(message, kind))


def mcap_ros2(folder: Path) -> Path:
    writer = pytest.importorskip("mcap_ros2.writer")
    path = folder / "arm.mcap"
    definition = (
        "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n"
        "float64[] effort\n" + "=" * 80 + "\nMSG: std_msgs/Header\n"
        "builtin_interfaces/Time stamp\nstring frame_id\n"
        + "=" * 80
        + "\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n"
    )
    with path.open("wb") as file:
        out = writer.Writer(file)
        schema = out.register_msgdef("sensor_msgs/msg/JointState", definition)
        for stamp, q in zip(map(int, STAMPS), JOINTS, strict=True):
            time = {"sec": stamp // 10**9, "nanosec": stamp % 10**9}
            message = {
                "header": {"stamp": time, "frame_id": ""},
                "name": ["j1", "j2", "j3"],
                "position": q.tolist(),
                "velocity": [],
                "effort": [],
            }
            out.write_message("/joint_states", schema, message, log_time=stamp)
        out.finish()
    return path


def robomimic(folder: Path) -> Path:
    h5py = pytest.importorskip("h5py")
    path = folder / "demo.hdf5"
    with h5py.File(path, "w") as file:
        data = file.create_group("data")
        data.attrs["total"] = 2 * T
        arguments = {"env_name": "Lift", "env_type": 1, "env_kwargs": {"control_freq": 20}}
        data.attrs["env_args"] = json.dumps(arguments)
        for n in (10, 2):
            demo = data.create_group(f"demo_{n}")
            demo.attrs["num_samples"] = T
            demo["actions"] = np.zeros((T, 7))
            demo["states"] = np.column_stack([TIME, JOINTS])
            demo["obs/robot0_eef_pos"] = POSITION + n
            demo["obs/robot0_eef_quat"] = XYZW
            demo["obs/image"] = np.zeros((T, 4, 4, 3), np.uint8)
    return path


def lerobot(folder: Path) -> Path:
    """As the published schema of version 3.0 has it."""
    pyarrow = pytest.importorskip("pyarrow")
    parquet = pytest.importorskip("pyarrow.parquet")
    path = folder / "dataset"
    scalars = ("timestamp", "frame_index", "episode_index", "index", "task_index")
    features = {name: {"dtype": "int64", "shape": [1], "names": None} for name in scalars}
    features["timestamp"]["dtype"] = "float32"
    for name in ("observation.state", "action"):
        features[name] = {"dtype": "float32", "shape": [3], "names": ["j1", "j2", "j3"]}
    features["observation.image"] = {"dtype": "video", "shape": [4, 4, 3], "names": None}
    info = {"codebase_version": "v3.0", "fps": 50, "total_episodes": 2, "total_frames": 2 * T}
    (path / "meta").mkdir(parents=True)
    (path / "meta" / "info.json").write_text(json.dumps(info | {"features": features}))
    frames = np.tile(np.arange(T), 2)
    fixed = pyarrow.list_(pyarrow.float32(), 3)
    state = pyarrow.array(np.vstack([JOINTS, JOINTS + 1]).astype(np.float32).tolist(), type=fixed)
    table = pyarrow.table(
        {
            "observation.state": state,
            "action": state,
            "timestamp": (frames / 50).astype(np.float32),
            "frame_index": frames,
            "episode_index": np.repeat([0, 1], T),
            "index": np.arange(2 * T),
            "task_index": np.zeros(2 * T, int),
        }
    )
    (path / "data" / "chunk-000").mkdir(parents=True)
    parquet.write_table(table, path / "data" / "chunk-000" / "file-000.parquet")
    return path


FILES = (text_csv, tum, euroc, npz, mat, rosbag1, rosbag2, mcap_ros2, robomimic, lerobot)


@pytest.fixture(scope="session")
def sample(tmp_path_factory):
    """Path of the sample in a format, by its name; written once."""
    makers = {maker.__name__: maker for maker in FILES}
    made: dict[str, Path] = {}

    def give(name: str) -> Path:
        if name not in made:
            made[name] = makers[name](tmp_path_factory.mktemp(name))
        return made[name]

    return give


@pytest.fixture(scope="session")
def truth():
    """What the samples hold."""
    from types import SimpleNamespace

    return SimpleNamespace(
        time=TIME,
        position=POSITION,
        quaternion=QUATERNION,
        joints=JOINTS,
        box=BOX,
        box_turn=BOX_TURN,
        turn=TURN,
        files=[maker.__name__ for maker in FILES],
    )
