"""Writes the logs of other formats that the tests read, each with the format's own library.

    python3 -m venv venv && venv/bin/pip install rosbags mcap pyarrow numpy zstandard lz4
    venv/bin/python tests/logs/make.py

What they hold is data/examples/arm/log0.csv: two joints read at 100 Hz, their setpoints in steps.
"""

import csv
import json
import math
import shutil
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from mcap.writer import CompressionType, Writer as McapWriter
from rosbags.rosbag1 import Writer as Ros1Writer
from rosbags.rosbag2 import CompressionFormat, CompressionMode, StoragePlugin, Writer as BagWriter
from rosbags.typesys import Stores, get_types_from_msg, get_typestore

HERE = Path(__file__).parent
JOINTS = ["shoulder", "elbow"]
START_NS = 1_700_000_000_000_000_000
STORE = get_typestore(Stores.ROS2_HUMBLE)
CONTROLLER = "control_msgs/msg/JointTrajectoryControllerState"
POINTS = "".join(f"trajectory_msgs/JointTrajectoryPoint {part}\n" for part in ["reference", "feedback", "error", "output"])
STORE.register(get_types_from_msg("std_msgs/Header header\nstring[] joint_names\n" + POINTS, CONTROLLER))
DYNAMIC = "control_msgs/msg/DynamicJointState"
STORE.register(get_types_from_msg("string[] interface_names\nfloat64[] values\n", "control_msgs/msg/InterfaceValue"))
STORE.register(get_types_from_msg("std_msgs/Header header\nstring[] joint_names\nInterfaceValue[] interface_values\n", DYNAMIC))
ROS1 = get_typestore(Stores.ROS1_NOETIC)
T = STORE.types


def arm():
    with open(HERE.parent.parent / "data/examples/arm/log0.csv", newline="") as file:
        rows = [[float(cell) for cell in row] for row in list(csv.reader(file))[1:]]
    rows = np.array(rows)
    return rows[:, 0], rows[:, [1, 3]], rows[:, [2, 4]]


def stamp(t):
    ns = START_NS + round(t * 1e9)
    return ns, T["builtin_interfaces/msg/Time"](sec=ns // 10**9, nanosec=ns % 10**9)


def header(t):
    return T["std_msgs/msg/Header"](stamp=stamp(t)[1], frame_id="base")


def state(t, q):
    nothing = np.array([], dtype=np.float64)
    return T["sensor_msgs/msg/JointState"](
        header=header(t), name=JOINTS, position=np.array(q), velocity=nothing, effort=nothing
    )


def trajectory(t, q):
    nothing = np.array([], dtype=np.float64)
    point = T["trajectory_msgs/msg/JointTrajectoryPoint"](
        positions=np.array(q),
        velocities=nothing,
        accelerations=nothing,
        effort=nothing,
        time_from_start=T["builtin_interfaces/msg/Duration"](sec=0, nanosec=10_000_000),
    )
    return T["trajectory_msgs/msg/JointTrajectory"](header=header(t), joint_names=JOINTS, points=[point])


def array(q):
    layout = T["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0)
    return T["std_msgs/msg/Float64MultiArray"](layout=layout, data=np.array(q))


def bag(t, q, q_ref):
    """Readings at every second sample, in messages that arrive late; commands without stamps, the elbow's first."""
    out = HERE / "bag"
    shutil.rmtree(out, ignore_errors=True)
    with BagWriter(out, version=8, storage_plugin=StoragePlugin.SQLITE3) as writer:
        kinds = ["sensor_msgs/msg/JointState", "std_msgs/msg/Float64MultiArray", "sensor_msgs/msg/JointState"]
        topics = ["/joint_states", "/position_controller/commands", "/gripper/joint_states"]
        readings, commands, _ = (writer.add_connection(*pair, typestore=STORE) for pair in zip(topics, kinds))
        for k in range(120):
            if k % 2 == 0:
                message = STORE.serialize_cdr(state(t[k], q[k]), kinds[0])
                writer.write(readings, stamp(t[k])[0] + 2_500_000, message)
            writer.write(commands, stamp(t[k])[0], STORE.serialize_cdr(array(q_ref[k][::-1]), kinds[1]))


def packed_bags(t, q, q_ref):
    """Packed by the message, and as a whole; the latter in two files, as long recordings are."""
    for name, mode in [("bag-messages", CompressionMode.MESSAGE), ("bag-files", CompressionMode.FILE)]:
        out = HERE / name
        shutil.rmtree(out, ignore_errors=True)
        writer = BagWriter(out, version=8, storage_plugin=StoragePlugin.SQLITE3)
        writer.set_compression(mode, CompressionFormat.ZSTD)
        with writer:
            kinds = ["sensor_msgs/msg/JointState", "trajectory_msgs/msg/JointTrajectory"]
            topics = ["/left/joint_states", "/left/arm_controller/joint_trajectory"]
            readings, commands = (writer.add_connection(*pair, typestore=STORE) for pair in zip(topics, kinds))
            for k in range(60):
                writer.write(commands, stamp(t[k])[0], STORE.serialize_cdr(trajectory(t[k], q_ref[k]), kinds[1]))
                writer.write(readings, stamp(t[k])[0], STORE.serialize_cdr(state(t[k], q[k]), kinds[0]))


def controller(t, q, q_ref):
    """A controller's state beside readings that are not numbers yet, one joint that never is, and dynamic states."""
    out = HERE / "controller"
    shutil.rmtree(out, ignore_errors=True)
    nothing = np.array([], dtype=np.float64)
    at_once = T["builtin_interfaces/msg/Duration"](sec=0, nanosec=0)

    def point(values):
        values = np.array(values, dtype=np.float64)
        return T["trajectory_msgs/msg/JointTrajectoryPoint"](
            positions=values, velocities=nothing, accelerations=nothing, effort=nothing, time_from_start=at_once
        )

    with BagWriter(out, version=8, storage_plugin=StoragePlugin.SQLITE3) as writer:
        kinds = [CONTROLLER, DYNAMIC]
        topics = ["/arm_controller/controller_state", "/dynamic_joint_states"]
        states, dynamic = (writer.add_connection(*pair, typestore=STORE) for pair in zip(topics, kinds))
        interface = T["control_msgs/msg/InterfaceValue"]
        for k in range(60):
            if k % 2 == 0:
                message = T[CONTROLLER](
                    header=header(t[k]),
                    joint_names=JOINTS,
                    reference=point(q_ref[k]),
                    feedback=point(q[k]),
                    error=point(q_ref[k] - q[k]),
                    output=point([]),
                )
                writer.write(states, stamp(t[k])[0], STORE.serialize_cdr(message, CONTROLLER))
            read = q[k] if k >= 4 else [math.nan, math.nan]
            values = [interface(["position", "velocity"], np.array([at, 0.0])) for at in [*read, math.nan]]
            message = T[DYNAMIC](header=header(t[k]), joint_names=[*JOINTS, "finger"], interface_values=values)
            writer.write(dynamic, stamp(t[k])[0], STORE.serialize_cdr(message, DYNAMIC))


def ros1(t, q, q_ref):
    """Bags of ROS 1; each joint's command is a topic of its own."""
    kinds = ["sensor_msgs/msg/JointState", "std_msgs/msg/Float64"]
    packings = [None, Ros1Writer.CompressionFormat.BZ2, Ros1Writer.CompressionFormat.LZ4]
    for name, packing in zip(["ros1", "ros1-bz2", "ros1-lz4"], packings):
        path = HERE / f"{name}.bag"
        path.unlink(missing_ok=True)
        writer = Ros1Writer(path)
        if packing:
            writer.set_compression(packing)
        with writer:
            readings = writer.add_connection("/arm/joint_states", kinds[0], typestore=ROS1)
            topics = [f"/arm/{name}_position_controller/command" for name in JOINTS]
            commands = [writer.add_connection(topic, kinds[1], typestore=ROS1) for topic in topics]
            types = ROS1.types
            for k in range(60):
                ns = stamp(t[k])[0]
                for j, command in enumerate(commands):
                    message = types["std_msgs/msg/Float64"](data=q_ref[k][j])
                    writer.write(command, ns, ROS1.serialize_ros1(message, kinds[1]))
                time = types["builtin_interfaces/msg/Time"](sec=ns // 10**9, nanosec=ns % 10**9)
                message = types["sensor_msgs/msg/JointState"](
                    header=types["std_msgs/msg/Header"](seq=k, stamp=time, frame_id="base"),
                    name=JOINTS,
                    position=np.array(list(q[k])),
                    velocity=np.array([]),
                    effort=np.array([]),
                )
                writer.write(readings, ns + 2_500_000, ROS1.serialize_ros1(message, kinds[0]))


def arrays_alone(t, q, q_ref):
    """An array with named fields, one with columns, and joints in rows under names that Python pickled."""
    fields = np.zeros(60, dtype=[("t", ">f8"), ("q", "<f4", (2,)), ("q_ref", "<f8", (2,))])
    fields["t"], fields["q"], fields["q_ref"] = t[:60], q[:60], q_ref[:60]
    np.save(HERE / "fields.npy", fields)
    np.save(HERE / "columns.npy", np.asfortranarray(np.column_stack([t[:60], q[:60, 1], q_ref[:60, 1]])))
    ns = np.array([stamp(at)[0] for at in t[:60]])
    names = np.array(JOINTS, dtype=object)
    np.savez_compressed(HERE / "turned.npz", timestamp=ns, positions=q[:60].T, commands=q_ref[:60].T, joint_names=names)


def plotted_controller(t, q, q_ref):
    root = "/arm_controller/controller_state"
    parts = [("error", q_ref - q), ("feedback", q), ("reference", q_ref)]
    head = ["__time"] + [f"{root}/{part}/positions[{j}]" for part, _ in parts for j in range(2)] + [f"{root}/header/stamp"]
    rows = [",".join(head)]
    for k in range(60):
        at = START_NS // 10**9 + t[k]
        cells = [f"{values[k][j]:.9f}" for _, values in parts for j in range(2)]
        rows.append(",".join([f"{at + 0.0025:.9f}", *cells, f"{at:.9f}"]))
    (HERE / "plotjuggler-controller.csv").write_text("\n".join(rows) + "\n")


def mcap_cdr(t, q, q_ref):
    with open(HERE / "arm.mcap", "wb") as file:
        writer = McapWriter(file, chunk_size=16_384, compression=CompressionType.ZSTD)
        writer.start("ros2", library="test")
        kinds = ["sensor_msgs/msg/JointState", "trajectory_msgs/msg/JointTrajectory"]
        channels = []
        for kind, topic in zip(kinds, ["/joint_states", "/arm_controller/joint_trajectory"]):
            text, _ = STORE.generate_msgdef(kind)
            schema = writer.register_schema(kind, "ros2msg", text.encode())
            channels.append(writer.register_channel(topic, "cdr", schema))
        for k in range(len(t)):
            ns = stamp(t[k])[0]
            # What is asked reaches the controller between two readings.
            for channel, message, kind, late in [
                (channels[1], trajectory(t[k], q_ref[k]), kinds[1], 0),
                (channels[0], state(t[k], q[k]), kinds[0], 3_000_000),
            ]:
                writer.add_message(channel, ns + late, bytes(STORE.serialize_cdr(message, kind)), ns + late)
        writer.finish()


def mcap_json(t, q, q_ref):
    with open(HERE / "arm-json.mcap", "wb") as file:
        writer = McapWriter(file, chunk_size=4096, compression=CompressionType.LZ4)
        writer.start("", library="test")
        schema = writer.register_schema("sensor_msgs/JointState", "jsonschema", b"{}")
        channels = [writer.register_channel(topic, "json", schema) for topic in ["/joint_states", "/joint_command"]]
        for k in range(100):
            ns = stamp(t[k])[0]
            for channel, values in zip(channels, [q[k], q_ref[k]]):
                secs = {"sec": ns // 10**9, "nsec": ns % 10**9}
                message = {"header": {"stamp": secs}, "name": JOINTS, "position": list(values)}
                writer.add_message(channel, ns, json.dumps(message).encode(), ns)
        writer.finish()


def lerobot(t, q, q_ref):
    """Degrees and a gripper from 0 to 100, at 50 frames a second, two episodes."""
    names = ["main_shoulder", "main_elbow", "main_gripper"]
    for version, parts in [("v2.1", [names, names]), ("v3.0", [[n[5:] + ".pos" for n in names]] * 2)]:
        root = HERE / f"lerobot-{version[:2]}"
        shutil.rmtree(root, ignore_errors=True)
        (root / "meta").mkdir(parents=True)
        (root / "data/chunk-000").mkdir(parents=True)
        feature = lambda own: {"dtype": "float32", "shape": [3], "names": own}
        info = {
            "codebase_version": version,
            "robot_type": "so101",
            "fps": 50,
            "features": {"observation.state": feature(parts[0]), "action": feature(parts[1])},
        }
        (root / "meta/info.json").write_text(json.dumps(info, indent=1) + "\n")
        episodes = []
        for episode, rows in enumerate([range(0, 300, 2), range(300, 500, 2)]):
            frames = np.arange(len(rows))
            grip = lambda shift: 50 + 45 * np.sin(frames / 10 + shift)
            wide = lambda values, shift: np.column_stack([np.degrees(values[list(rows)]), grip(shift)]).astype(np.float32)
            lists = lambda values: pa.array(list(values), pa.list_(pa.float32()))
            table = {
                "observation.state": lists(wide(q, 0.0)),
                "action": lists(wide(q_ref, 0.3)),
                "timestamp": pa.array((frames / 50).astype(np.float32)),
                "frame_index": pa.array(frames),
                "episode_index": pa.array(np.full(len(rows), episode)),
                "index": pa.array(frames + episode * 150),
                "task_index": pa.array(np.zeros(len(rows), dtype=np.int64)),
            }
            episodes.append(pa.table(table))
        if version == "v2.1":
            for k, table in enumerate(episodes):
                pq.write_table(table, root / f"data/chunk-000/episode_{k:06}.parquet")
        else:
            pq.write_table(pa.concat_tables(episodes), root / "data/chunk-000/file-000.parquet")


def tables(t, q, q_ref):
    head = "__time,/joint_states/header/stamp,"
    head += ",".join(f"/joint_states/{name}/position" for name in JOINTS)
    head += "," + ",".join(f"/position_controller/commands/data[{k}]" for k in range(2))
    rows = []
    for k in range(len(t)):
        at = f"{START_NS // 10**9 + t[k]:.9f}"
        late = f"{START_NS // 10**9 + t[k] + 0.0025:.9f}"
        rows.append((late, f"{late},{at},{q[k][0]:.4f},{q[k][1]:.4f},,"))
        rows.append((at, f"{at},,,,{q_ref[k][0]:.7f},{q_ref[k][1]:.7f}"))
    rows.sort(key=lambda row: float(row[0]))
    (HERE / "plotjuggler.csv").write_text("\n".join([head] + [row for _, row in rows]) + "\n")
    ns = [START_NS + round(at * 1e9) for at in t[:60]]
    echo = ["%time,field.header.seq,field.header.stamp,field.header.frame_id,field.name0,field.name1,field.position0,field.position1"]
    echo += [f"{at + 400},{k},{at},base,{JOINTS[0]},{JOINTS[1]},{q[k][0]},{q[k][1]}" for k, at in enumerate(ns)]
    (HERE / "echo.csv").write_text("\n".join(echo) + "\n")
    long = ["stamp,name,position"]
    long += [f"{at},{name},{q[k][j]}" for k, at in enumerate(ns) for j, name in enumerate(JOINTS)]
    (HERE / "long.csv").write_text("\n".join(long) + "\n")
    frame = ["Time,header.seq,header.stamp.secs,header.stamp.nsecs,header.frame_id,name,position,velocity,effort"]
    frame += [
        f"{at * 1e-9},{k},{at // 10**9},{at % 10**9},base,\"{JOINTS}\",\"({q[k][0]}, {q[k][1]})\",(),()"
        for k, at in enumerate(ns)
    ]
    (HERE / "frame.csv").write_text("\n".join(frame) + "\n")


def bam(t, q, q_ref):
    entries = [
        {"timestamp": t[k], "position": q[k][1], "speed": 0.0, "load": 3, "goal_position": q_ref[k][1], "torque_enable": k < 80}
        for k in range(100)
    ]
    bench = {"mass": 0.49, "length": 0.1, "kp": 100, "vin": 7.4, "motor": "xl330", "trajectory": "sin_sin", "entries": entries}
    (HERE / "bam.json").write_text(json.dumps(bench) + "\n")


if __name__ == "__main__":
    t, q, q_ref = arm()
    bag(t, q, q_ref)
    packed_bags(t, q, q_ref)
    controller(t, q, q_ref)
    ros1(t, q, q_ref)
    arrays_alone(t, q, q_ref)
    plotted_controller(t, q, q_ref)
    mcap_cdr(t, q, q_ref)
    mcap_json(t, q, q_ref)
    lerobot(t, q, q_ref)
    tables(t, q, q_ref)
    bam(t, q, q_ref)
    np.savez_compressed(HERE / "arm.npz", t=t[:200], q=q[:200], q_ref=q_ref[:200].astype(np.float32), joint_names=np.array(JOINTS))
