"""MuJoCo in the league: rings of capsules, plain and with speculative contacts.

Usage: python in_mujoco.py SCENES.json FOLDER

MuJoCo has no coefficient of restitution. Elastic contacts are springs without damping, with a contact time of ten steps,
and the integrator that keeps their energy best.
"""

import math

import mujoco
import numpy
from league import scenes, steps, write


def text(numbers):
    return " ".join(repr(float(x)) for x in numbers)


def geoms(shape):
    if shape["half"]:
        return f'<geom type="box" size="{text(shape["half"])}"/>'
    capsule = '<geom type="capsule" fromto="{}" size="{}"/>'
    return "".join(capsule.format(text(c[:6]), c[6]) for c in shape["capsules"])


def model(league, world, speculative):
    stiffness = (math.pi / (10 * world["dt"])) ** 2
    solref = f'solref="{-stiffness} 0"' if world["restitution"] == 1 else ""
    integrator = "RK4" if world["restitution"] == 1 else "implicitfast"
    contact = 'condim="1"' if world["friction"] == 0 else f'condim="3" friction="{world["friction"]} 0 0"'
    xml = f'<mujoco><size memory="500M"/><option timestep="{world["dt"]}" gravity="0 {world["gravity"]} 0"'
    xml += f' integrator="{integrator}" cone="elliptic"><flag autoreset="disable" speculative="{speculative}"/></option>'
    xml += f"<default><geom {contact} {solref}/></default><worldbody>"
    for wall in world["walls"]:
        xml += f'<geom type="box" pos="{text(wall["center"])}" size="{text(wall["half"])}"/>'
    for body in world["bodies"]:
        shape = league["shapes"][body["shape"]]
        inertia = f'<inertial pos="0 0 0" mass="{shape["mass"]}" diaginertia="{text(shape["inertia"])}"/>'
        xml += f"<body><freejoint/>{inertia}{geoms(shape)}</body>"
    return mujoco.MjModel.from_xml_string(xml + "</worldbody></mujoco>")


def turned(quaternion, vector, back=False):
    """A vector turned by a quaternion w, x, y, z, or back."""
    w, x, y, z = quaternion
    result = numpy.zeros(3)
    mujoco.mju_rotVecQuat(result, vector, [w, -x, -y, -z] if back else [w, x, y, z])
    return result


def run(league, world, speculative):
    physics = model(league, world, speculative)
    data = mujoco.MjData(physics)
    for k, body in enumerate(world["bodies"]):
        x, y, z, w = body["rotation"]
        data.qpos[7 * k : 7 * k + 7] = [*body["position"], w, x, y, z]
        # Angular velocities are in the body's frame here.
        spin = turned([w, x, y, z], body["spin"], back=True)
        data.qvel[6 * k : 6 * k + 6] = [*body["velocity"], *spin]

    def state():
        for k in range(len(world["bodies"])):
            place, turn = data.qpos[7 * k : 7 * k + 3], data.qpos[7 * k + 3 : 7 * k + 7]
            w, x, y, z = turn
            velocity, spin = data.qvel[6 * k : 6 * k + 3], data.qvel[6 * k + 3 : 6 * k + 6]
            yield [*place, x, y, z, w, *velocity, *turned(turn, spin)]

    return steps(world, lambda: mujoco.mj_step(physics, data), state)


league = scenes()
for setting, speculative in [("plain", "disable"), ("speculative", "enable")]:
    worlds = [run(league, world, speculative) for world in league["worlds"]]
    write("MuJoCo", mujoco.__version__, setting, worlds)
