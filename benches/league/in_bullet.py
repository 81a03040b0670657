"""Bullet in the league, through PyBullet: rings of capsules, with swept spheres against tunnelling.

Usage: python in_bullet.py SCENES.json FOLDER

Rings come from URDF files, since a shape array keeps 16 shapes of the 24 and says nothing.
"""

import math
import sys
from importlib.metadata import version
from pathlib import Path

import pybullet
from league import scenes, steps, write

INERTIAL = '<inertial><mass value="{}"/><inertia ixx="{}" iyy="{}" izz="{}" ixy="0" ixz="0" iyz="0"/></inertial>'


def capsule(ends):
    """A URDF capsule lies along z: it is turned about x, then about z."""
    a, b, radius = ends[:3], ends[3:6], ends[6]
    middle = " ".join(str((p + q) / 2) for p, q in zip(a, b))
    x, y, z = (q - p for p, q in zip(a, b))
    length = math.hypot(x, y, z)
    pitch, yaw = math.acos(z / length), math.atan2(y, x)
    geometry = f'<geometry><capsule radius="{radius}" length="{length}"/></geometry>'
    return f'<collision><origin xyz="{middle}" rpy="0 {pitch} {yaw}"/>{geometry}</collision>'


def collision(shape):
    if shape["half"]:
        size = " ".join(str(2 * h) for h in shape["half"])
        return f'<collision><geometry><box size="{size}"/></geometry></collision>'
    return "".join(capsule(c) for c in shape["capsules"])


def save(shape, path):
    inertial = INERTIAL.format(shape["mass"], *shape["inertia"])
    path.write_text(f'<robot name="b"><link name="b">{inertial}{collision(shape)}</link></robot>')


def run(league, world, files):
    pybullet.resetSimulation()
    pybullet.setGravity(0, world["gravity"], 0)
    pybullet.setPhysicsEngineParameter(fixedTimeStep=world["dt"], restitutionVelocityThreshold=0.0)
    if world["restitution"] > 0:
        # Bullet pushes bodies apart with speeds that stay theirs; without, elastic ones keep their energy.
        pybullet.setPhysicsEngineParameter(erp=0.0, contactERP=0.0)
    touch = {"lateralFriction": world["friction"] ** 0.5, "restitution": world["restitution"] ** 0.5}
    for wall in world["walls"]:
        box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=wall["half"])
        fixed = pybullet.createMultiBody(0, box, basePosition=wall["center"])
        pybullet.changeDynamics(fixed, -1, **touch)
    bodies = []
    for body in world["bodies"]:
        shape = league["shapes"][body["shape"]]
        made = pybullet.loadURDF(
            str(files[body["shape"]]),
            body["position"],
            body["rotation"],
            flags=pybullet.URDF_USE_INERTIA_FROM_FILE,
        )
        swept = shape["capsules"][0][6] if shape["capsules"] else shape["half"][0]
        pybullet.changeDynamics(made, -1, linearDamping=0, angularDamping=0, ccdSweptSphereRadius=swept, **touch)
        pybullet.resetBaseVelocity(made, body["velocity"], body["spin"])
        bodies.append(made)

    def state():
        for body in bodies:
            place, turn = pybullet.getBasePositionAndOrientation(body)
            velocity, spin = pybullet.getBaseVelocity(body)
            yield [*place, *turn, *velocity, *spin]

    return steps(world, pybullet.stepSimulation, state)


league = scenes()
pybullet.connect(pybullet.DIRECT)
files = [Path(sys.argv[2], f"shape_{k}.urdf") for k in range(len(league["shapes"]))]
for shape, path in zip(league["shapes"], files):
    save(shape, path)
worlds = [run(league, world, files) for world in league["worlds"]]
write("PyBullet", version("pybullet"), "swept sphere", worlds)
