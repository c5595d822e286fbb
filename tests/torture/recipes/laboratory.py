"""Good calls of the laboratory: ``tpsim.lab``, and what it returns."""

import tempfile
from dataclasses import replace
from pathlib import Path

import numpy as np
from recipe import Book, Made

from tpsim import GMM, HSMM, S3, Gaussian, R, RiemannianGaussian, SemiMarkovChain, lab
from tpsim.robot.objects import Objects
from tpsim.robot.views.direction import Direction
from tpsim.robot.views.joints import Spare
from tpsim.robot.views.sites import Sight as SeenSite
from tpsim.robot.views.view import Beneath, Offset, Part
from tpsim.task.environment import Environment
from tpsim.task.performance import Performance
from tpsim.world.people.guide import HandPath

FOLDER = Path(tempfile.mkdtemp(prefix="torture-"))
STUDY = lab.load_study(f"{Path(__file__).parents[2] / 'study' / 'toy.py'}:study")
TASK = STUDY.task
WORLD = TASK.stage
ROBOT = WORLD.robot
TAUGHT = lab.teach(TASK)
MODELS = lab.learn(TASK, TAUGHT)
SITUATION = lab.draw_situation(TASK, 0, 0)
START = np.array(SITUATION.start)
TIP, MARK = lab.Site("tip"), lab.Object("mark")
VIEW = TIP.seen_from(MARK).position
POSE = lab.Pose(np.eye(3), np.array([0.3, 0.2, 0.0]))
OBJECTS = {"mark": POSE}
STATE = ROBOT.at(START, 0.1 * START, OBJECTS)
SKILL = lab.Skill(TASK.behaviours()["bring"].views, MODELS["bring"])
PUSH = lab.Push("tip", (1.0, 0.0, 0.0), 0.01, 0.02)
LEAD = lab.Lead("tip", (0.3, 0.2, 0.0), (0.0, 0.01, 0.0), 0.01, 0.02, 0.01)
CONDITION = lab.Condition("unpushed", SITUATION, duration=0.04)
SHORT = {"duration": 0.02}
TRIAL = lab.perform(TASK, MODELS, SITUATION, people=[PUSH], **SHORT)
RECORDS = lab.Records(TASK, MODELS, [(CONDITION, TRIAL)])
PATH = lab.straight((0.3, 0.2, 0.0), (0.0, 0.01, 0.0), 0.02, 0.01, WORLD.timestep)
GUIDE = lab.Guide("hand", "tip", lab.Grip(400.0, 40.0, 0.0, 0.0), PATH)
ARM = (Path(__file__).parents[2] / "study" / "toy.py").read_text().split('"""')[3].replace(
    '<geom type="mesh" mesh="mark" contype="0" conaffinity="0"/>', ""
).replace('<asset><mesh name="mark" file="mark.obj"/></asset>', "")  # fmt: skip
URDF = """<robot name="r"><link name="base"/><link name="link"><inertial><mass value="1"/>
<origin xyz="0.1 0 0"/><inertia ixx="0.1" iyy="0.1" izz="0.1" ixy="0" ixz="0" iyz="0"/></inertial>
</link><joint name="j" type="revolute"><parent link="base"/><child link="link"/><axis xyz="0 1 0"/>
<limit lower="-1" upper="1" effort="20" velocity="3"/></joint></robot>"""


def book() -> Book:
    """All of them."""
    book = Book()
    for chapter in (_robot, _views, _worlds, _people, _control, _tasks, _studies, _deploy):
        chapter(book)
    return book


def _robot(book: Book) -> None:
    add = book.add
    add("lab.Pose.__matmul__", POSE.__matmul__, other=POSE)
    add(
        "lab.Pose.at",
        lab.Pose(np.tile(np.eye(3), (2, 1, 1)), np.ones((2, 3))).at,
        index=1,
        takes={"index": {"slice", "ellipsis"}},
    )
    add(
        "lab.Pose.of_quaternion",
        lab.Pose.of_quaternion,
        position=np.ones(3),
        quaternion=np.array([1.0, 0.0, 0.0, 0.0]),
    )
    limits = {"torque_limit": 30.0, "velocity_limit": {".*": 2.0}}
    hands = {"hand": "tip"}
    add(
        "lab.Robot.from_mjcf",
        lab.Robot.from_mjcf,
        takes={name: {"no dict"} for name in ("torque_limit", "velocity_limit", "home")},
        words=("limits", "file", "MJCF", "URDF"),
        source=ARM,
        hands=hands,
        home=(0.4, 0.9),
        others="locked",
        **limits,
    )
    urdf = FOLDER / "robot.urdf"
    urdf.write_text(URDF)
    add(
        "lab.Robot.from_urdf",
        lab.Robot.from_urdf,
        takes={name: {"no dict"} for name in ("torque_limit", "velocity_limit", "home")},
        words=("limits", "file", "MJCF", "URDF"),
        path=str(urdf),
        hands={"hand": "link"},
        packages=None,
        home={"j": 0.1},
        **limits,
    )
    grip = lab.Gripper("tip", (0.01, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    add(
        "lab.Gripper",
        lab.Gripper,
        at="tip",
        position=(0.01, 0.0, 0.0),
        reach=(1.0, 0.0, 0.0),
        across=(0.0, 1.0, 0.0),
    )
    add("lab.Chain", lab.Chain, site="tip")
    add(
        "lab.Arms",
        lab.Arms,
        takes={name: {"dict", "no dict"} for name in ("torque_limit", "velocity_limit", "home")},
        words=("limits", "file", "MJCF", "arms"),
        file=ARM,
        grippers={"left": grip},
        elbows={},
        torque_limit=30.0,
        velocity_limit=2.0,
        home=(0.4, 0.9),
    )
    add("lab.Robot.at", ROBOT.at, q=START, dq=0.1 * START, objects=OBJECTS, time=0.1)
    add("lab.Robot.chain", ROBOT.chain, site="tip")
    add("lab.Robot.frame_of", ROBOT.frame_of, site="tip")
    add("lab.Robot.index", ROBOT.index, joints="sh.*")
    add("lab.Robot.index", ROBOT.index, joints=("elbow",))
    add("lab.Robot.span", ROBOT.span, joints="sh.*")
    add("lab.Robot.gravity_torque", ROBOT.gravity_torque, q=START)
    add("lab.Robot.is_comfortable", ROBOT.is_comfortable, q=START, margin=0.15, load=0.8)
    for method in ("jacobian", "pose", "twist"):
        add(f"lab.State.{method}", getattr(STATE, method), site="tip")
    add("lab.Objects.of", Objects.of, poses=OBJECTS)
    for method in ("row", "covariance"):
        add(f"lab.Objects.{method}", getattr(STATE.objects, method), words=("object",), name="mark")
    add("lab.Objects.__getitem__", STATE.objects.__getitem__, words=("object",), name="mark")
    add(
        "lab.reach",
        lab.reach,
        words=("poses", "site", "target"),
        robot=ROBOT,
        targets={"tip": STATE.pose("tip")},
        start=START,
        posture=START,
        margin=0.05,
        tolerance=(2e-4, 1e-3),
        iterations=130,
    )
    add(
        "lab.satisfy",
        lab.satisfy,
        robot=ROBOT,
        views=[lab.Joints().minus([0.1, 0.2])],
        start=START,
        objects=STATE.objects,
    )


def _views(book: Book) -> None:
    add = book.add
    joints = lab.Joints()
    add("lab.Joints", lab.Joints, names=".*")
    add("lab.Object", lab.Object, name="mark")
    add("lab.Site", lab.Site, name="tip")
    add("lab.Site.axis", TIP.axis, words=("axes",), axis="z", across="", reference=np.eye(3))
    add("lab.Site.seen_from", TIP.seen_from, base=MARK)
    add("lab.Sight", SeenSite, site=TIP, base=MARK)
    add(
        "lab.Sight",
        lab.Sight,
        delay=0.2,
        interval=0.3,
        first=0.0,
        gain=0.15,
        smoothing=0.1,
    )
    add("lab.Handover", lab.Handover, first=VIEW, then=VIEW, start=0.1, end=0.3)
    add("lab.OnPath", lab.OnPath, site="tip", path=len, free=("path",))
    add("lab.Direction", Direction, site="tip", axes="zxy", reference=None)
    add("lab.Direction.towards", TIP.axis("z").towards, target=MARK)
    add("lab.View.__call__", VIEW.__call__, state=STATE)
    add("lab.View.__getitem__", VIEW.__getitem__, words=("indices", "view"), rows=[0, 1])
    add("lab.View.__getitem__", VIEW.__getitem__, words=("indices", "view"), rows=0)
    add(
        "lab.View.beneath",
        lambda first, bend, damping: joints.beneath(first, bend=bend, damping=damping),
        first=VIEW,
        bend=0.5,
        damping=0.01,
    )
    add("lab.View.minus", VIEW.minus, origin=np.ones(3))
    add("lab.View.scale", VIEW.scale, robot=ROBOT, unit="mm")
    add(
        "lab.Joints.spare",
        lambda first, origin, joints_free, damping: joints.spare(
            first, origin=origin, free=joints_free, damping=damping
        ),
        first=VIEW,
        origin=START,
        joints_free=("elbow",),
        words=("free",),
        damping=0.01,
    )
    add("lab.Beneath", Beneath, second=joints, first=(VIEW,), bend=0.5, damping=0.01)
    add("lab.Offset", Offset, takes={"origin": {"generator"}}, whole=VIEW, origin=(1.0, 0.0, 0.0))
    add("lab.Part", Part, whole=VIEW, indices=(0, 1))
    add("lab.Spare", Spare, names=".*", first=(VIEW,), origin=None)
    places = {"mark": (np.ones((3, 3)), np.tile([1.0, 0, 0, 0], (3, 1)))}
    add(
        "lab.observe",
        lab.observe,
        robot=ROBOT,
        views=[VIEW, joints],
        q=np.tile(START, (3, 1)),
        objects=places,
    )


def _worlds(book: Book) -> None:
    add = book.add
    add("lab.Camera", lab.Camera, position=(1.0, 1.0, 1.0), target=(0.0, 0.0, 0.0), fovy=32.0)
    add(
        "lab.Held",
        lab.Held,
        model="cup",
        site="tip",
        position=(0.0, 0.0, 0.0),
        axes=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
    )
    add(
        "lab.Grasp",
        lab.Grasp,
        model="lump",
        site="tip",
        position=(0.0, 0.0, 0.0),
        axes=((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)),
        stand="other",
        on_stand=(0.0, 0.0, 0.009),
        target="other",
        at_target=(0.0, 0.0, 0.1),
    )
    add("lab.Placed", lab.Placed, model="marker", position=(0.0, 0.0, 0.0), paint=(0.1, 0.2, 0.3))
    robot = lab.Robot.from_mjcf(ARM, {"hand": "tip"}, torque_limit=30, home=(0.4, 0.9))
    camera = lab.Camera((1.0, 1.0, 1.0), (0.0, 0.0, 0.0))
    add(
        "lab.world",
        lab.world,
        robot=robot,
        objects={"other": "marker"},
        held={"cup": lab.Held("cup", "tip")},
        floor=0.0,
        cameras={"mine": camera},
    )
    add(
        "lab.World",
        lab.World,
        xml=WORLD.xml,
        description=WORLD.description,
        assets=dict(WORLD.assets),
    )
    add("lab.World.compose", lab.World.compose, robot=robot, spec=None)
    add("lab.World.with_home", WORLD.with_home, home=START)
    add("lab.World.simulation", WORLD.simulation, plant=lab.Plant(mass=0.1))
    add(
        "lab.Plant",
        lab.Plant,
        mass=0.1,
        payload=0.2,
        friction=0.1,
        latency=0.002,
        encoder_bits=12,
        velocity_cutoff=40.0,
        control_period=0.004,
        perception=lab.Perception(),
        seed=0,
    )
    add(
        "lab.Perception",
        lab.Perception,
        rate=20.0,
        latency=0.05,
        position_noise=0.005,
        angle_noise=0.03,
        wander=(0.005, 0.02),
        occluded=(("mark", 1.0, 2.0),),
        before=1.0,
        seed=0,
    )
    add("lab.Perception.remembered", lab.Perception().remembered, trial=TRIAL)
    add("lab.Perception.hides", lab.Perception().hides, name="mark", time=1.0)
    add("lab.PoseFilter", lab.PoseFilter, noise=(0.005, 0.03), wander=(0.005, 0.02))
    seeing = lab.PoseFilter()
    seeing.see(POSE, 0.0)
    add("lab.PoseFilter.see", seeing.see, pose=POSE, time=0.1)
    add("lab.PoseFilter.at", seeing.at, time=0.1)
    add("lab.Plant.model", lab.Plant(mass=0.1).model, nominal=WORLD.model, robot=ROBOT)
    simulation = WORLD.simulation
    add(
        "lab.Simulation.attachment",
        lambda name: simulation().attachment(name),
        words=("site",),
        name="tip",
    )
    add("lab.Simulation.reset", lambda q: simulation().reset(q), q=START)
    add(
        "lab.rollout",
        lab.rollout,
        patient=("duration",),
        world=WORLD,
        controller=Made(lambda: lab.FixedImpedance(START, 100.0)),
        start=START,
        duration=0.02,
        sites={"hand": "tip"},
        people=[PUSH, GUIDE],
        objects=[lab.ObjectPath.at("mark", (0, 0, 0))],
        plant=lab.Plant(latency=0.002),
    )
    add(
        "lab.Trial",
        lab.Trial,
        arrays=dict(TRIAL.arrays),
        outcome="done",
        channels=TRIAL.channels,
        about={"seed": 0},
        touched="",
        keeps=("arrays",),
    )
    add("lab.Trial.__getitem__", TRIAL.__getitem__, words=("signal",), name="q")
    add("lab.Trial.pose", TRIAL.pose, words=("signal",), name="mark")
    add("lab.Trial.with_about", TRIAL.with_about, outcome="done")
    add(
        "lab.ObjectPath",
        lab.ObjectPath,
        name="mark",
        positions=((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)),
        times=(0.0, 1.0),
        quaternions=((1.0, 0.0, 0.0, 0.0), (0.0, 1.0, 0.0, 0.0)),
    )
    add(
        "lab.ObjectPath.at",
        lab.ObjectPath.at,
        name="mark",
        position=(0.0, 0.0, 1.0),
        quaternion=(1.0, 0.0, 0.0, 0.0),
    )
    moving = lab.ObjectPath("mark", ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0)), (0.0, 1.0))
    add("lab.ObjectPath.poses", moving.poses, times=np.array([0.0, 0.5]))


def _people(book: Book) -> None:
    add = book.add
    grip = {"stiffness": 400.0, "damping": 40.0, "angular_stiffness": 60.0, "angular_damping": 2.5,
            "max_force": 60.0, "max_torque": 8.0}  # fmt: skip
    add("lab.Grip", lab.Grip, infinite=True, **grip)
    add("lab.Grip.braking", lab.Grip(**grip).braking, mass=5.0, inertia=0.1, ratio=0.5)
    add(
        "lab.HandPath",
        HandPath,
        position=np.ones((3, 3)),
        rotation=np.tile(np.eye(3), (3, 1, 1)),
        velocity=np.zeros((3, 3)),
        angular_velocity=np.zeros((3, 3)),
    )
    add(
        "lab.Guide",
        lab.Guide,
        name="hand",
        site="tip",
        grip=lab.Grip(),
        path=PATH,
        relative_to=None,
        start=0.0,
        sight=lab.Sight(),
        care=lab.Care(),
    )
    add(
        "lab.Drag",
        lab.Drag,
        infinite=True,
        name="push",
        body="tip",
        times=(0.0, 0.1),
        positions=((0.3, 0.2, 0.0), (0.3, 0.25, 0.0)),
        quaternions=((1.0, 0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0)),
        until=0.2,
        point=(0.0, 0.0, 0.0),
        grip=lab.Grip(),
        relative_to="tip",
        smoothing=0.04,
    )
    add(
        "lab.Push",
        lab.Push,
        body="tip",
        force=(1.0, 0.0, 0.0),
        start=0.1,
        duration=0.2,
        point=(0.0, 0.0, 0.0),
        torque=(0.0, 0.0, 1.0),
        ramp=0.05,
    )
    add(
        "lab.Lead",
        lab.Lead,
        infinite=True,
        site="tip",
        origin=(0.3, 0.2, 0.0),
        travel=(0.0, 0.01, 0.0),
        start=0.1,
        duration=0.2,
        rest=0.1,
        stiffness=2000.0,
        max_force=60.0,
    )
    add(
        "lab.Variation",
        lab.Variation,
        drift=0.002,
        tremor=0.0006,
        angular_drift=0.01,
        angular_tremor=0.003,
        drift_time=0.7,
        tremor_time=0.1,
        pace=0.2,
        warp=0.3,
        tremor_band=(8.0, 12.0),
        speed_noise=0.01,
        angular_speed_noise=0.01,
        attention=0.35,
    )
    add("lab.Care", lab.Care, position=np.ones(3), rotation=np.ones((4, 3)))
    add(
        "lab.Demonstrator",
        lab.Demonstrator,
        grip=lab.Grip(),
        variation=lab.Variation(),
        reaction=(0.1, 0.2),
        looks="in turn",
    )
    add("lab.Demonstrator.sights", lab.HUMAN.sights, patient=("hands",), rng=0, hands=2)
    add("lab.Rehearsed", lab.Rehearsed, teacher=TASK.lesson, free=("teacher",))
    add(
        "lab.Rehearsed.__call__",
        lab.Rehearsed(TASK.lesson),
        words=("teacher",),
        world=WORLD,
        rng=0,
    )
    add(
        "lab.script",
        lab.script,
        words=("seconds", "times", "step"),
        rotations=np.tile(np.eye(3), (3, 1, 1)),
        positions=np.arange(9.0).reshape(3, 3),
        seconds=0.1,
        timestep=0.002,
        rng=0,
        variation=lab.Variation(),
    )
    add(
        "lab.straight",
        lab.straight,
        words=("seconds", "times", "step"),
        origin=(0.3, 0.2, 0.0),
        travel=(0.0, 0.01, 0.0),
        seconds=0.1,
        rest=0.05,
        timestep=0.002,
    )
    add(
        "lab.through",
        lab.through,
        words=("seconds", "times", "step"),
        times=np.array([0.0, 0.1]),
        postures=np.ones((2, 2)),
        timestep=0.002,
    )
    add(
        "lab.hand_path",
        lab.hand_path,
        robot=ROBOT,
        site="tip",
        postures=np.tile(START, (5, 1)),
        timestep=0.002,
        rng=0,
        variation=lab.Variation(),
    )
    add(
        "lab.Lesson",
        lab.Lesson,
        start=START,
        guides=(GUIDE,),
        duration=0.1,
        held=("elbow",),
        objects=(lab.ObjectPath.at("mark", (0, 0, 0)),),
    )


def _control(book: Book) -> None:
    add = book.add
    add("lab.Impedance.weaker", lab.Impedance(np.eye(2), np.eye(2), START).weaker, factor=2.0)
    add("lab.Skill", lab.Skill, views=dict(SKILL.views), model=SKILL.model)
    prior = Gaussian(START, np.eye(2))
    add(
        "lab.MinimalIntervention",
        lab.MinimalIntervention,
        skills=[SKILL],
        effort=0.05,
        bandwidth=10.0,
        friction=180.0,
        prior=prior,
        period=0.016,
    )
    add(
        "lab.Spring",
        lab.Spring,
        takes={"reference": {"class", "function"}},
        view=VIEW,
        stiffness=[300.0, 200.0, 100.0],
        reference=np.ones(3),
    )
    add(
        "lab.CartesianImpedance",
        lab.CartesianImpedance,
        words=("spring",),
        springs=[lab.Spring(VIEW, 300.0)],
        posture=START,
        posture_stiffness=4.0,
        damping=1.0,
        period=0.008,
    )
    # A class may be called, as a function is.
    add("lab.Aim", lab.Aim, view=VIEW, gain=100.0, reference=np.ones(3), damping=1.0,
        takes={"reference": {"class"}})  # fmt: skip
    add(
        "lab.OperationalSpace",
        lab.OperationalSpace,
        words=("aim",),
        aims=[lab.Aim(VIEW, 100.0)],
        posture=START,
        posture_gain=4.0,
        damping=1.0,
        period=0.008,
    )
    add(
        "lab.ComputedTorque",
        lab.ComputedTorque,
        takes={"trajectory": {"class", "function"}},
        trajectory=START,
        gain=100.0,
        damping=1.0,
        period=0.008,
    )
    add(
        "lab.InverseKinematics",
        lab.InverseKinematics,
        words=("aim",),
        aims=[lab.Aim(VIEW, 100.0)],
        start=START,
        posture=START,
        posture_gain=4.0,
    )
    add("lab.Pursuit", lab.Pursuit, skills=[SKILL], effort=0.05, bandwidth=10.0, period=0.025)
    add(
        "lab.TimedIntervention",
        lab.TimedIntervention,
        skill=_timed_skill(),
        until=0.3,
        effort=0.05,
        bandwidth=10.0,
        prior=prior,
        period=0.03,
    )
    tracked = lab.Site("tip").position[:2]
    states = np.tile(np.eye(4), (2, 1, 1))
    hsmm = HSMM(SemiMarkovChain.along([0, 0, 1]), GMM([0.5, 0.5], Gaussian(np.eye(2, 4), states)))
    add(
        "lab.SemiMarkovTracking",
        lab.SemiMarkovTracking,
        words=("every",),
        view=tracked,
        model=hsmm,
        dt=0.03,
        effort=0.1,
        horizon=9,
        slip=0.5,
        constraints=lambda state: [],
        rng=0,
    )
    add("lab.FixedImpedance", lab.FixedImpedance, posture=START, stiffness=100.0)
    place = np.tile([0.0, 0, 0, 1, 0, 0, 0], (9, 1))
    movement = RiemannianGaussian(R(3) * S3, place, np.eye(6))
    add(
        "lab.FiniteHorizon",
        lab.FiniteHorizon,
        words=("posture",),
        robot=ROBOT,
        objects=["mark"],
        movements=[movement],
        posture=Gaussian(np.tile(START, (9, 1)), np.eye(2)),
        joints=("shoulder", "elbow"),
        site="tip",
        dt=0.05,
        effort=0.1,
        period=0.008,
        chain=SemiMarkovChain.along(np.repeat([0, 1, 2], 3)),
    )
    add("lab.Hold", lab.Hold, site="tip", start=0.5, duration=1.0, grip=lab.Grip())
    add("lab.Tank", lab.Tank, infinite=True, initial=1.0, capacity=2.0)
    add("lab.Tank.of", lab.Tank.of, robot=ROBOT)
    add("lab.Weightless", lab.Weightless, robot=ROBOT, damping=0.5, held=("elbow",), posture=START)


def _timed_skill() -> lab.Skill:
    """A skill whose model has time before the view."""
    import tpsim
    from tpsim.task.task import demonstration

    views = dict(SKILL.views)
    seen = [demonstration(WORLD, trial, views).with_time() for trial in TAUGHT["bring"]]
    return lab.Skill(views, tpsim.fit_tp_gmm(seen, 2))


def _tasks(book: Book) -> None:
    add = book.add
    add(
        "lab.Behaviour",
        lab.Behaviour,
        views=dict(SKILL.views),
        teacher=TASK.lesson,
        fit=len,
        keeps=("views",),
        infinite=True,
        free=("views", "teacher", "fit"),
    )
    add("lab.Goal", lab.Goal, view=VIEW, within=0.01, since=0.0, until=1.0, infinite=True)
    add(
        "lab.Situation",
        lab.Situation,
        start=tuple(START.tolist()),
        objects=(lab.ObjectPath.at("mark", (0, 0, 0)),),
        seed=0,
        index=0,
    )
    add("lab.Task.in_world", TASK.in_world, world=WORLD)
    add("lab.Task.outcome", TASK.outcome, trial=TRIAL)
    add("lab.draw_situation", lab.draw_situation, task=TASK, seed=0, index=1)
    add(
        "lab.teach",
        lab.teach,
        patient=("count",),
        task=TASK,
        count=1,
        seed=0,
        behaviours=["bring"],
    )
    add("lab.learn", lab.learn, words=("demonstration",), task=TASK, taught=dict(TAUGHT))
    add(
        "lab.perform",
        lab.perform,
        patient=("duration",),
        task=TASK,
        models=dict(MODELS),
        situation=SITUATION,
        controller=None,
        people=[PUSH],
        duration=0.02,
        plant=lab.Plant(),
    )
    options = {"models": dict(MODELS), "action": "torque", "duration": 0.1,
               "control_timestep": 0.004,
               "stiffness": 100.0, "people": [PUSH], "plant": lab.Plant()}  # fmt: skip
    add("lab.environment", lab.environment, task=TASK, seed=0, **options)
    add("lab.gym_environment", lab.gym_environment, task=TASK, seed=0, render_mode=None, **options)
    add("lab.Performance", Performance, task=TASK, **options)
    add("lab.Performance.act", lambda action: Performance(TASK).act(action), action=np.ones(2))
    add(
        "lab.Performance.begin",
        lambda seed, index: Performance(TASK).begin(seed, index),
        seed=0,
        index=1,
    )
    performance = Performance(TASK)
    add(
        "lab.TaskEnvironment",
        lambda **options: _gym()(performance, **options),
        seed=0,
        render_mode=None,
    )
    add(
        "lab.TaskEnvironment.reset",
        lambda **options: lab.gym_environment(TASK).reset(**options),
        seed=0,
        options=None,
        free=("options",),
    )
    add("lab.TaskEnvironment.step", lambda action: _ready().step(action), action=np.ones(2))
    movement = lab.environment(TASK).task
    add("lab.Environment", Environment, movement=movement)


def _gym():
    from tpsim.task.gymnasium import TaskEnvironment

    return TaskEnvironment


def _ready():
    env = lab.gym_environment(TASK)
    env.reset(seed=0)
    return env


def _studies(book: Book) -> None:
    add = book.add
    measure = STUDY.measures[0]
    add(
        "lab.Condition",
        lab.Condition,
        label="pushed",
        situation=SITUATION,
        controller="learned",
        push=(PUSH,),
        lead=(LEAD,),
        plant=lab.Plant(),
        duration=0.1,
        shown=None,
    )
    add(
        "lab.Measure",
        lab.Measure,
        takes={"window": {"one inf"}},
        infinite=True,
        name="gap",
        of=VIEW,
        unit="mm",
        whole=None,
        label="unpushed",
        otherwise=None,
        controller="learned",
        reduce=np.max,
        across=max,
        window=(0.0, 1.0),
        limit=10.0,
        at_least=False,
        title="Gap",
    )
    add("lab.Measure.figure", measure.figure, records=RECORDS)
    add("lab.Measure.numbers", measure.numbers, records=RECORDS)
    add("lab.Measure.number", measure.number, record=RECORDS[0])
    add("lab.Measure.series", measure.series, record=RECORDS[0])
    # What never comes is infinite.
    add("lab.Measure.result", measure.result, infinite=True, value=1.0)
    error = lab.Error("gap", len, "mm", 10.0)
    add("lab.Error", lab.Error, name="gap", of=len, unit="mm", scale=10.0, title="Gap")
    add("lab.Range", lab.Range, low=1.0, high=10.0, unit="N/m")
    ranges = {"stiffness": lab.Range(1.0, 10.0)}
    add("lab.Expert", lab.Expert, ranges=ranges, make=len, gains={"stiffness": 2.0})
    add(
        "lab.Contest",
        lab.Contest,
        errors=[error],
        pushes=len,
        lead=None,
        experts={"mine": lab.Expert(ranges, len)},
        gains=None,
        yielding=10.0,
        duration=1.0,
        situations=3,
        tuning_situations=2,
        twins=True,
        counts=len,
        variants=len,
        apart=True,
        rest="rest",
        pushed="pushed",
        led="led",
    )
    add("lab.rms", lab.rms, values=np.ones(3))
    add(
        "lab.Record",
        lab.Record,
        condition=CONDITION,
        trial=TRIAL,
        task=TASK,
        models=dict(MODELS),
        all=RECORDS,
    )
    add("lab.Record.__getitem__", RECORDS[0].__getitem__, words=("signal",), name="q")
    add("lab.Record.beside", RECORDS[0].beside, label="unpushed", controller=None)
    add("lab.Record.see", RECORDS[0].see, view=VIEW)
    add("lab.Records", lab.Records, task=TASK, models=dict(MODELS), trials=[(CONDITION, TRIAL)])
    add("lab.Records.__getitem__", RECORDS.__getitem__, index=0, takes={"index": {"slice"}})
    add(
        "lab.Records.add",
        lambda condition, trial: lab.Records(TASK, MODELS).add(condition, trial),
        condition=CONDITION,
        trial=TRIAL,
    )
    add("lab.Records.include", lab.Records(TASK, MODELS).include, record=RECORDS[0])
    add("lab.Records.groups", RECORDS.groups, texts={"unpushed": "Not pushed"})
    add("lab.Records.select", RECORDS.select, label="unpushed", controller="learned")
    add(
        "lab.load_study",
        lab.load_study,
        words=("study",),
        reference="cup-and-sugar",
        names={"cup-and-sugar": "tpsim.tasks.tracking.study:study"},
    )
    add("lab.Lab", lab.Lab, study=STUDY, models=dict(MODELS), taught=dict(TAUGHT))
    add("lab.Span", lab.Span, low=0.5, high=1.5)
    people = {"body": ("tip",), "direction": "circle", "duration": (0.1,)}
    add("lab.Pushes", lab.Pushes, force=(1.0,), onset=lab.Span(0, 1), **people)
    add("lab.Leads", lab.Leads, travel=(0.01,), phase=(0.5,), rest=0.1, **people)
    add("lab.Sweep", lab.Sweep, values=(1, 2), learn=False, free=("values",), keeps=("values",))
    described = lab.Campaign("toy.py:study", pushes=lab.Pushes(duration=(0.1,)))
    add("lab.Campaign.check", described.check, study=STUDY)
    add(
        "lab.Campaign",
        lab.Campaign,
        free=("fields", "study"),
        study="toy.py:study",
        trials=3,
        fields={"effort": 0.1},
        controllers=("learned",),
        teachers=1,
        plants=("nominal",),
        pushes=lab.Pushes(),
        sweeps={"effort": lab.Sweep((0.1, 0.2))},
        design="grid",
        repeats=1,
        duration=1.0,
        keep="figures",
        success=("gap",),
        seed=0,
    )
    add("lab.Plan", lab.Plan, seed=0, situations=2, pushes=1)
    add("lab.Plan.rng", lambda key: lab.Plan().rng(key), key=1)
    add(
        "lab.Study",
        lab.Study,
        task=TASK,
        measures=[measure],
        controllers=dict(STUDY.controllers),
        probes={},
        title="t",
        lead="l",
    )
    add("lab.Study.about", STUDY.about, words=("task", "study"), task=TASK)
    add("lab.Study.in_world", STUDY.in_world, world=WORLD)
    add(
        "lab.Study.with_task",
        STUDY.with_task,
        effort=0.1,
        free=("effort",),
        keeps=("effort",),
        infinite=True,
    )
    add("lab.pushes_all_round", lab.pushes_all_round, force=20.0, body="tip")
    add(
        "lab.Clip",
        lab.Clip,
        world=WORLD,
        time=np.array([0.0, 0.1]),
        q=np.ones((2, 2)),
        title="t",
        subtitle="s",
        traces=(np.ones((2, 3)),),
        objects={"mark": np.ones((2, 3))},
        camera="",
        speed=1.0,
    )
    add(
        "lab.Clip.of",
        lab.Clip.of,
        world=WORLD,
        trial=TRIAL,
        title="t",
        subtitle="s",
        camera="",
        speed=1.0,
    )
    nothing = replace(STUDY, conditions=_no_conditions, measures=())
    add(
        "lab.run",
        lambda **given: lab.run(video=False, **given),  # films and pools have tests of their own
        study=nothing,
        plan=lab.Plan(0, 1, 0),
        folder=Made(_folder),
        progress=False,
        command="torture",
    )


def _no_conditions(lab, plan):
    yield []


def _folder() -> Path:
    return Path(tempfile.mkdtemp(dir=FOLDER)) / "run"


def _deploy(book: Book) -> None:
    add = book.add
    policy = lab.Policy(TASK, MODELS)
    saved = policy.save(FOLDER / "policy")
    pair = (300.0, 30.0)
    add(
        "lab.CartesianLimits",
        lab.CartesianLimits,
        stiffness=pair,
        damping=pair,
        stiffness_rate=pair,
        damping_rate=pair,
        pull=pair,
    )
    add("lab.Policy", lab.Policy, task=TASK, models=dict(MODELS), situation=SITUATION)
    add(
        "lab.Policy.load",
        lab.Policy.load,
        folder=str(saved),
        period=None,
        limits=lab.CartesianLimits(),
        views=(),
    )
    add("lab.Policy.save", policy.save, folder=Made(lambda: str(_folder())))
    add(
        "lab.Policy.command",
        lambda **given: lab.Policy(TASK, MODELS).command(**given),
        q=START,
        dq=0 * START,
        objects={"mark": (np.ones(3), np.array([1.0, 0.0, 0.0, 0.0]))},
    )
    add(
        "lab.Policy.cartesian",
        lambda **given: lab.Policy(TASK, MODELS).cartesian(**given),
        q=START,
        dq=0 * START,
        objects={"mark": (np.ones(3), np.array([1.0, 0.0, 0.0, 0.0]))},
    )
